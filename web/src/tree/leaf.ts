/** A single value of a message as text: exact, or it says that it is not. */
import { h, say, svg } from "../dom";
import { moment, plural, span, whole } from "../format";
import { byteLength, bytesOf, type Field, isBytes, kindOf, own } from "../types";

/** Characters of a string that are shown. */
const CHARACTERS = 2000;
const BYTES = 16;

/** Called with the path of a number that somebody wants to see plotted. */
export type PlotPath = (path: string) => void;

/** One line of a tree, or a branch of it. */
export interface Item {
  readonly element: HTMLElement;
  /** Shows another value; tells whether it could, for what it is made for. */
  show(value: unknown): boolean;
}

export class Leaf implements Item {
  readonly element: HTMLElement;
  readonly #value = h("span", { class: "tree-value" });
  readonly #field: Field | undefined;

  constructor(
    plot: PlotPath | undefined,
    label: string,
    path: string,
    value: unknown,
    field: Field | undefined,
  ) {
    this.#field = field;
    this.element = h(
      "div",
      { class: "tree-leaf" },
      h("span", { class: "tree-key" }, `${label}:`),
      this.#value,
    );
    if (plot !== undefined && isPlottable(value, field))
      this.element.append(plotButton(path, plot));
    this.show(value);
  }

  show(value: unknown): boolean {
    const kind = this.#field === undefined ? undefined : kindOf(this.#field.type);
    const isTime = kind === "time" || kind === "duration";
    if (typeof value === "object" && value !== null && !isTime) return false;
    const [text, style, title] = leafText(value, this.#field);
    say(this.#value, text);
    this.#value.className = `tree-value tree-${style}`;
    if (title === "") this.#value.removeAttribute("title");
    else this.#value.title = title;
    return true;
  }
}

function isPlottable(value: unknown, field: Field | undefined): boolean {
  if (field === undefined) return typeof value === "number" || typeof value === "boolean";
  return field.array < 0 && kindOf(field.type) !== "string";
}

/** A small button with a curve on it. */
export function plotButton(path: string, plot: PlotPath): HTMLButtonElement {
  return h(
    "button",
    {
      type: "button",
      class: "tree-plot",
      title: `Plot ${path}`,
      "aria-label": `Plot ${path}`,
      onclick: () => plot(path),
    },
    curve(),
  );
}

function curve(): SVGElement {
  const line = {
    fill: "none",
    stroke: "currentColor",
    "stroke-width": 1.75,
    "stroke-linecap": "round",
  };
  return svg(
    "svg",
    { viewBox: "0 0 16 12", "aria-hidden": "true" },
    svg("path", { d: "M1 9 C4 9 5 2 8 2 S11 10 15 7", ...line }),
  );
}

/** A value's text, its style, and what is to be said about it. */
export function leafText(
  value: unknown,
  field: Field | undefined,
): [text: string, style: string, title: string] {
  if (value === null)
    return ["nan", "word", "Not a number: JSON has null for it, and for infinity"];
  if (typeof value === "string") {
    if (field !== undefined && isBytes(field)) return [bytesText(value), "bytes", ""];
    if (value.length <= CHARACTERS) return [`"${value}"`, "string", ""];
    const rest = whole(value.length - CHARACTERS);
    return [`"${value.slice(0, CHARACTERS)}" … ${rest} more characters`, "string", ""];
  }
  if (typeof value === "number") {
    const isInteger =
      field === undefined ? Number.isInteger(value) : kindOf(field.type) === "integer";
    if (isInteger && !Number.isSafeInteger(value)) {
      return [
        `≈ ${BigInt(value)}`,
        "number",
        "Numbers of a browser are exact up to 2^53 only: the last digits may differ",
      ];
    }
    return [String(value), "number", ""];
  }
  const [secs, nsecs] = [own(value, "secs"), own(value, "nsecs")];
  if (typeof secs === "number" && typeof nsecs === "number") {
    const text = field?.type === "duration" ? span(secs, nsecs) : moment(secs, nsecs);
    return [text, "time", `${secs} s and ${nsecs} ns`];
  }
  return [String(value), "word", ""];
}

function bytesText(base64: string): string {
  const length = byteLength(base64);
  const first = bytesOf(base64.slice(0, Math.ceil(BYTES / 3) * 4))?.slice(0, BYTES) ?? [];
  const hex = Array.from(first, (byte) => byte.toString(16).padStart(2, "0")).join(" ");
  return `${plural(length, "byte")}${hex && `: ${hex}`}${length > BYTES ? " …" : ""}`;
}
