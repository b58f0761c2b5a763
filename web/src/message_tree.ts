/** A message as a tree of its values, which keeps its open branches while the messages change. */
import "./message_tree.css";

import { h, setText, svg } from "./dom";
import { elementNames } from "./element_names";
import { dragFields } from "./field_drag";
import { dateTime, duration, plural, whole } from "./format";
import { bytes, elements, numberText } from "./messages/values";
import { byteLength, type Field, isBytes, kindOf, own, type Types, typeText } from "./types";

/** How many elements of an array are shown at first, added by each click, and shown at most. */
const FIRST = 50;
const STEP = 200;
const MAX_ELEMENTS = 2000;
/** Branches up to this length and down to this depth are open at first. */
const SHORT = 8;
const DEPTH = 2;
/** How many values the preview of a closed branch has. */
const PREVIEW = 4;
/** How many characters of a string and bytes of a byte string are shown. */
const MAX_CHARACTERS = 2000;
const MAX_BYTES = 16;

export class MessageTree {
  readonly element = h("div", { class: "tree" });
  readonly #branch: Children;
  readonly #type: string;

  /** Without types, values are shown as in JSON; with a topic, its fields can be dragged onto plots. */
  constructor(types: Types | undefined, type: string, plot?: PlotPath, topic?: string) {
    this.#type = type;
    this.#branch = new Children(
      this.element,
      { types, plot, isDragged: topic !== undefined },
      "",
      0,
    );
    if (topic !== undefined) dragFields(this.element, topic);
  }

  show(message: unknown): void {
    this.#branch.show(message, { name: "", type: this.#type, array: -1 }, []);
  }
}

/** The messages around a value, innermost first: they may name elements of arrays. */
type Owners = readonly unknown[];

interface LeafContext {
  readonly plot: PlotPath | undefined;
  /** Whether fields can be dragged onto plots. */
  readonly isDragged: boolean;
}

interface Context extends LeafContext {
  readonly types: Types | undefined;
}

/** The fields of a message or the elements of an array. */
class Children {
  readonly #place: HTMLElement;
  readonly #context: Context;
  readonly #path: string;
  readonly #depth: number;
  readonly #items = new Map<string, Item>();
  /** The labels of the items. */
  readonly #labels = new Map<string, string>();
  readonly #more = h("button", {
    type: "button",
    class: "tree-more",
    onclick: () => this.#showMore(),
  });
  #limit = FIRST;
  #value: unknown;
  #field: Field | undefined;
  #owners: Owners = [];

  constructor(place: HTMLElement, context: Context, path: string, depth: number) {
    this.#place = place;
    this.#context = context;
    this.#path = path;
    this.#depth = depth;
  }

  /** Show other values; `owners` are the messages around them, innermost first. */
  show(value: unknown, field: Field | undefined, owners: Owners): void {
    this.#value = value;
    this.#field = field;
    this.#owners = owners;
    const list = elements(value);
    if (list === undefined) this.#showMessage(value, field);
    else this.#showArray(list, field);
  }

  #showMore(): void {
    this.#limit = Math.min(MAX_ELEMENTS, this.#limit + STEP);
    this.show(this.#value, this.#field, this.#owners);
  }

  #showMessage(value: unknown, field: Field | undefined): void {
    const owners = [value, ...this.#owners];
    const keys =
      typeof value === "object" && value !== null ? Object.keys(value).slice(0, this.#limit) : [];
    for (const key of keys) {
      const inner = field === undefined ? undefined : this.#context.types?.field(field.type, key);
      const path = this.#path === "" ? key : `${this.#path}.${key}`;
      this.#put(key, key, path, own(value, key), inner, owners);
    }
    this.#removeExcept(new Set(keys));
    if (keys.length === 0)
      this.#place.replaceChildren(h("span", { class: "tree-note" }, "no fields"));
  }

  #showArray(values: ArrayLike<unknown>, field: Field | undefined): void {
    const element = field === undefined ? undefined : { ...field, array: -1 };
    const shown = Math.min(values.length, this.#limit);
    const names = elementNames(values, keyOf(this.#path), this.#owners);
    for (let at = 0; at < shown; at += 1) {
      const name = names?.[at];
      const label = name === undefined ? `[${at}]` : `[${at}] ${name}`;
      const path = `${this.#path}[${name ?? at}]`;
      this.#put(String(at), label, path, values[at], element, this.#owners);
    }
    for (let at = this.#items.size - 1; at >= shown; at -= 1) this.#remove(String(at));
    this.#place.classList.toggle("of-leaves", typeof values[0] !== "object");
    const isWide = typeof values[0] === "string" || names?.some((name) => name !== undefined);
    this.#place.classList.toggle("wide", isWide === true);
    const rest = values.length - shown;
    if (rest === 0) {
      this.#more.remove();
    } else {
      const isLimit = this.#limit >= MAX_ELEMENTS;
      setText(
        this.#more,
        isLimit ? `… ${whole(rest)} more: copy as JSON to see all` : `… ${whole(rest)} more`,
      );
      this.#more.disabled = isLimit;
      if (this.#place.lastChild !== this.#more) this.#place.append(this.#more);
    }
  }

  #put(
    key: string,
    label: string,
    path: string,
    value: unknown,
    field: Field | undefined,
    owners: Owners,
  ): void {
    const existing = this.#items.get(key);
    if (this.#labels.get(key) === label && existing?.show(value, owners) === true) return;
    const item = makeItem(this.#context, label, path, value, field, this.#depth, owners);
    this.#items.set(key, item);
    this.#labels.set(key, label);
    if (existing === undefined) this.#place.append(item.element);
    else existing.element.replaceWith(item.element);
  }

  #removeExcept(keys: ReadonlySet<string>): void {
    for (const key of [...this.#items.keys()]) if (!keys.has(key)) this.#remove(key);
  }

  #remove(key: string): void {
    this.#items.get(key)?.element.remove();
    this.#items.delete(key);
    this.#labels.delete(key);
  }
}

/** The field at the end of a path. */
function keyOf(path: string): string {
  return /([A-Za-z_]\w*)$/.exec(path)?.[1] ?? "";
}

function makeItem(
  context: Context,
  label: string,
  path: string,
  value: unknown,
  field: Field | undefined,
  depth: number,
  owners: Owners,
): Item {
  const single = field === undefined || field.array < 0;
  const kind = field === undefined ? undefined : kindOf(field.type);
  const isTime = single && (kind === "time" || kind === "duration");
  if (typeof value === "object" && value !== null && !isTime && !isByteString(value, field)) {
    return new Branch(context, label, path, value, field, depth, owners);
  }
  return new Leaf(context, label, path, value, field);
}

/** Whether a value is shown as bytes, and not as an array of numbers. */
function isByteString(value: unknown, field: Field | undefined): boolean {
  if (field === undefined) return value instanceof Uint8Array;
  return isBytes(field) && (typeof value === "string" || value instanceof Uint8Array);
}

class Branch implements Item {
  readonly element: HTMLDetailsElement;
  readonly #note = h("span", { class: "tree-note" });
  readonly #preview = h("span", { class: "tree-preview" });
  readonly #types: Types | undefined;
  readonly #children: Children;
  readonly #field: Field | undefined;
  readonly #isArray: boolean;
  #value: unknown;
  #owners: Owners = [];

  constructor(
    context: Context,
    label: string,
    path: string,
    value: object,
    field: Field | undefined,
    depth: number,
    owners: Owners,
  ) {
    this.#field = field;
    this.#isArray = elements(value) !== undefined;
    this.#types = context.types;
    const place = h("div", { class: "tree-children" });
    this.#children = new Children(place, context, path, depth + 1);
    this.element = h(
      "details",
      { class: "tree-branch", open: depth < DEPTH && isShort(value) },
      h(
        "summary",
        {},
        // Of an array, all elements are dragged; a message has nothing to plot.
        keyElement(context, label, this.#isArray ? `${path}[:]` : ""),
        " ",
        this.#note,
        this.#preview,
      ),
      place,
    );
    // A closed branch is not updated.
    this.element.addEventListener("toggle", () => this.#update());
    this.show(value, owners);
  }

  show(value: unknown, owners: Owners): boolean {
    if (typeof value !== "object" || value === null) return false;
    if ((elements(value) !== undefined) !== this.#isArray) return false;
    this.#value = value;
    this.#owners = owners;
    setText(this.#note, this.#describe(value));
    this.#update();
    return true;
  }

  #update(): void {
    if (this.element.open) this.#children.show(this.#value, this.#field, this.#owners);
    setText(this.#preview, this.element.open ? "" : preview(this.#value, this.#field, this.#types));
  }

  #describe(value: object): string {
    const type = this.#field === undefined ? "" : typeText(this.#field);
    const list = elements(value);
    return list === undefined ? type : `${type} ${plural(list.length, "element")}`.trim();
  }
}

function isShort(value: object): boolean {
  const length = elements(value)?.length ?? Object.keys(value).length;
  return length > 0 && length <= SHORT;
}

/** The first few values of a closed branch: ` x: 1.5, y: 0` or ` 1, 2, 3, …`. */
function preview(value: unknown, field: Field | undefined, types: Types | undefined): string {
  const list = elements(value);
  const isArray = list !== undefined;
  const element = field === undefined ? undefined : { ...field, array: -1 };
  const all = Object.entries(
    isArray
      ? Array.from({ length: Math.min(list.length, PREVIEW + 1) }, (_, at) => list[at])
      : Object(value),
  );
  const texts = all.flatMap(([name, each]) => {
    const inner = isArray ? element : field && types?.field(field.type, name);
    const isLeaf = isByteString(each, inner) || own(each, "nsecs") !== undefined;
    if (typeof each === "object" && each !== null && !isLeaf) return [];
    const text = leafText(isFraction(each) ? Number(each.toPrecision(5)) : each, inner)[0];
    return [isArray ? text : `${name}: ${text}`];
  });
  if (texts.length === 0) return "";
  const few = texts
    .slice(0, PREVIEW)
    .join(isArray ? ", " : "  ")
    .slice(0, 120);
  return `  ${few}${texts.length > PREVIEW ? ", …" : ""}`;
}

function isFraction(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value) && !Number.isInteger(value);
}

/** Receives the path of a number that the user wants to plot. */
export type PlotPath = (path: string) => void;

/** A leaf or a branch of the tree. */
export interface Item {
  readonly element: HTMLElement;
  /** Show another value; returns false if it needs another kind of item. */
  show(value: unknown, owners: Owners): boolean;
}

export class Leaf implements Item {
  readonly element: HTMLElement;
  readonly #value = h("span", { class: "tree-value" });
  readonly #field: Field | undefined;

  constructor(
    context: LeafContext,
    label: string,
    path: string,
    value: unknown,
    field: Field | undefined,
  ) {
    const { plot } = context;
    this.#field = field;
    this.element = h("div", { class: "tree-leaf" }, keyElement(context, label, path), this.#value);
    if (plot !== undefined && isPlottable(value, field))
      this.element.append(plotButton(path, plot));
    this.show(value);
  }

  show(value: unknown): boolean {
    const kind = this.#field === undefined ? undefined : kindOf(this.#field.type);
    const isTime = kind === "time" || kind === "duration";
    if (typeof value === "object" && value !== null && !isTime && !isByteString(value, this.#field))
      return false;
    const [text, style, title] = leafText(value, this.#field);
    setText(this.#value, text);
    this.#value.className = `tree-value tree-${style}`;
    if (title === "") this.#value.removeAttribute("title");
    else this.#value.title = title;
    return true;
  }
}

/** The name of a field, which can be dragged by its path. */
function keyElement({ isDragged }: LeafContext, label: string, path: string): HTMLElement {
  const field = isDragged && path !== "" && path;
  return h(
    "span",
    { class: "tree-key", draggable: field && "true", "data-field": field },
    `${label}:`,
  );
}

function isPlottable(value: unknown, field: Field | undefined): boolean {
  if (field === undefined) return ["number", "bigint", "boolean"].includes(typeof value);
  return field.array < 0 && kindOf(field.type) !== "string";
}

/** A small button with the icon of a curve. */
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
    curveIcon(),
  );
}

function curveIcon(): SVGElement {
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

/** The text of a value, its style, and its tooltip. */
export function leafText(
  value: unknown,
  field: Field | undefined,
): [text: string, style: string, title: string] {
  if (value === null)
    return ["nan", "word", "Not a number: JSON has null for nan and for infinity"];
  if (isByteString(value, field)) return [bytesText(value as string | Uint8Array), "bytes", ""];
  if (typeof value === "string") {
    if (value.length <= MAX_CHARACTERS) return [`"${value}"`, "string", ""];
    const rest = whole(value.length - MAX_CHARACTERS);
    return [`"${value.slice(0, MAX_CHARACTERS)}" … ${rest} more characters`, "string", ""];
  }
  if (typeof value === "number" && isRounded(value, field)) {
    return [
      `≈ ${BigInt(value)}`,
      "number",
      "JSON has integers exactly only up to 2^53 here: the last digits may differ",
    ];
  }
  if (typeof value === "number" || typeof value === "bigint") {
    return [numberText(value), Number.isNaN(value) ? "word" : "number", ""];
  }
  const [secs, nsecs] = [own(value, "secs"), own(value, "nsecs")];
  if (typeof secs === "number" && typeof nsecs === "number") {
    const text = field?.type === "duration" ? duration(secs, nsecs) : dateTime(secs, nsecs);
    return [text, "time", `${secs} s and ${nsecs} ns`];
  }
  return [String(value), "word", ""];
}

/** Whether a number was an integer in JSON, of which a browser may have lost the last digits. */
function isRounded(value: number, field: Field | undefined): boolean {
  const isInteger =
    field === undefined ? Number.isInteger(value) : kindOf(field.type) === "integer";
  return isInteger && !Number.isSafeInteger(value);
}

/** The first bytes of an array, or of base64 text. */
function bytesText(value: string | Uint8Array): string {
  const length = typeof value === "string" ? byteLength(value) : value.length;
  const start = typeof value === "string" ? value.slice(0, Math.ceil(MAX_BYTES / 3) * 4) : value;
  const hex = Array.from(bytes(start).subarray(0, MAX_BYTES), (byte) =>
    byte.toString(16).padStart(2, "0"),
  ).join(" ");
  return `${plural(length, "byte")}${hex && `: ${hex}`}${length > MAX_BYTES ? " …" : ""}`;
}
