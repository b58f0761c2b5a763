/** Shows the joints of a robot as bars between their limits. */
import { h, reorder, setText } from "../../dom";
import { plural } from "../../format";
import type { Hub, Message } from "../../hub";
import { ParameterServer } from "../../parameters/parameters";
import { own } from "../../types";
import type { Reading } from "./panel";

/** How many joints are shown. */
const MAX_JOINTS = 200;
/** The range of a joint that has no limits, which grows with its positions: half a turn each way. */
const HALF_TURN = Math.PI;

/** What the robot's description says of a joint. */
export interface JointLimits {
  /** `revolute`, `continuous`, `prismatic` and others. */
  readonly type: string;
  readonly lower: number | undefined;
  readonly upper: number | undefined;
}

/**
 * The joints in a robot's description (URDF), by their names.
 *
 * Source: http://wiki.ros.org/urdf/XML/joint. A description that is not well-formed has those that
 * are found; joints without a limit in its `limit` have none.
 */
export function jointsOf(urdf: string): Map<string, JointLimits> {
  const found = new Map<string, JointLimits>();
  const text = urdf.replace(/<!--.*?(-->|$)/gs, "");
  for (const part of text.split(/<joint\b/).slice(1)) {
    const [tag = ""] = part.split(">", 1);
    const name = attribute(tag, "name");
    // Joints of transmissions have no type.
    const type = attribute(tag, "type");
    if (name === undefined || type === undefined) continue;
    const [body = ""] = part.split("</joint", 1);
    const limit = /<limit\b([^>]*)/.exec(body)?.[1];
    // A continuous joint turns without an end; its `limit` is that of its speed.
    const number = (key: string): number | undefined => {
      if (limit === undefined || type === "continuous") return undefined;
      const value = Number(attribute(limit, key) ?? 0);
      return Number.isFinite(value) ? value : undefined;
    };
    found.set(name, { type, lower: number("lower"), upper: number("upper") });
  }
  return found;
}

function attribute(tag: string, name: string): string | undefined {
  const found = new RegExp(`\\s${name}\\s*=\\s*(?:"([^"]*)"|'([^']*)')`).exec(tag);
  return found === null ? undefined : (found[1] ?? found[2]);
}

interface Row {
  readonly element: HTMLElement;
  readonly bar: HTMLElement;
  readonly note: HTMLElement;
  /** Position, velocity and effort. */
  readonly cells: readonly HTMLElement[];
  low: number;
  high: number;
}

export class Joints implements Reading {
  readonly element: HTMLElement;
  readonly #rows = new Map<string, Row>();
  readonly #body = h("tbody");
  readonly #more = h("p", { class: "soft small", hidden: true });
  #limits = new Map<string, JointLimits>();

  /** The limits are those of `robot_description` in the topic's namespace, or in the root. */
  constructor(hub: Hub, topic: string) {
    this.element = h(
      "div",
      {},
      h(
        "table",
        { class: "joints" },
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            ...["Joint", "", "Position", "Velocity", "Effort"].map((label, at) =>
              h("th", { scope: "col", class: at > 1 && "number" }, label),
            ),
          ),
        ),
        this.#body,
      ),
      this.#more,
    );
    void this.#loadLimits(hub, topic);
  }

  show(message: Message): void {
    const names = Array.isArray(message.name) ? message.name.map(String) : [];
    names.forEach((name, at) => {
      const row = this.#row(name);
      if (row === undefined) return;
      const values = ["position", "velocity", "effort"].map((key) => {
        const value = own(own(message, key), String(at));
        return typeof value === "number" ? value : undefined;
      });
      this.#update(name, row, values);
    });
    const hidden = names.filter((name) => !this.#rows.has(name)).length;
    this.#more.hidden = hidden === 0;
    setText(this.#more, `and ${plural(hidden, "more joint")}; only ${MAX_JOINTS} are shown`);
  }

  async #loadLimits(hub: Hub, topic: string): Promise<void> {
    const parameters = new ParameterServer(hub);
    const namespace = topic.slice(0, topic.lastIndexOf("/"));
    for (const name of new Set([`${namespace}/robot_description`, "/robot_description"])) {
      // Nobody may read parameters here, or they are something else: bars have no limits then.
      const text = await parameters.get(name, "").catch(() => "");
      const urdf: unknown = JSON.parse(text || "null");
      if (typeof urdf !== "string" || urdf === "") continue;
      this.#limits = jointsOf(urdf);
      for (const [joint, row] of this.#rows) this.#setRange(joint, row);
      return;
    }
  }

  #row(name: string): Row | undefined {
    const found = this.#rows.get(name);
    if (found !== undefined || this.#rows.size >= MAX_JOINTS) return found;
    const bar = h("div", { class: "joint-bar", "aria-hidden": "true" });
    const note = h(
      "span",
      { class: "joint-note", title: "Beyond its limit", hidden: true },
      "⚠",
      h("span", { class: "visually-hidden" }, " beyond its limit"),
    );
    const cells = Array.from({ length: 3 }, () => h("td", { class: "number mono" }));
    const element = h(
      "tr",
      {},
      h("th", { scope: "row", class: "mono" }, name, " ", note),
      h("td", { class: "joint-range" }, bar),
      ...cells,
    );
    const row: Row = { element, bar, note, cells, low: -HALF_TURN, high: HALF_TURN };
    this.#setRange(name, row);
    this.#rows.set(name, row);
    const sorted = [...this.#rows.keys()].sort((one, other) =>
      one.localeCompare(other, undefined, { numeric: true }),
    );
    reorder(
      this.#body,
      sorted.flatMap((each) => this.#rows.get(each)?.element ?? []),
    );
    return row;
  }

  #setRange(name: string, row: Row): void {
    const { lower, upper } = this.#limits.get(name) ?? {};
    if (lower === undefined || upper === undefined || lower >= upper) return;
    row.low = lower;
    row.high = upper;
  }

  #update(name: string, row: Row, values: readonly (number | undefined)[]): void {
    const { type, lower, upper } = this.#limits.get(name) ?? { type: "" };
    const [position] = values;
    const unit = type === "prismatic" ? " m" : type === "" ? "" : " rad";
    const units = [unit, unit && `${unit}/s`, type === "prismatic" ? " N" : unit && " Nm"];
    row.cells.forEach((cell, at) => {
      const value = values[at];
      setText(cell, value === undefined ? "–" : `${value.toFixed(3)}${units[at]}`);
    });
    const isLimited = lower !== undefined && upper !== undefined && lower < upper;
    if (position !== undefined && !isLimited) {
      row.low = Math.min(row.low, position);
      row.high = Math.max(row.high, position);
    }
    const isBeyond = isLimited && position !== undefined && (position < lower || position > upper);
    row.bar.classList.toggle("beyond", isBeyond);
    row.note.hidden = !isBeyond;
    row.bar.hidden = position === undefined;
    if (position === undefined) return;
    // The bar begins at zero, or at the end that is nearer to it.
    const part = (value: number): number =>
      Math.min(1, Math.max(0, (value - row.low) / (row.high - row.low)));
    const [from, to] = [part(0), part(position)].sort((one, other) => one - other) as [
      number,
      number,
    ];
    row.bar.style.setProperty("--from", `${(100 * from).toFixed(1)}%`);
    row.bar.style.setProperty("--length", `${(100 * (to - from)).toFixed(1)}%`);
    row.bar.title = isLimited ? `${lower} to ${upper}${unit}` : "";
  }
}
