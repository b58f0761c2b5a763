/** Shows the joints of a robot as bars between their limits. */
import { h, setText } from "../../dom";
import { plural } from "../../format";
import type { Message } from "../../hub";
import { KeyedRows } from "../../keyed_rows";
import { fixedText } from "../../messages/values";
import { ParameterServer } from "../../parameters/parameters";
import type { DataSource } from "../../source";
import { own } from "../../types";
import type { Joint } from "../scene/robot/urdf";
import type { Reading } from "./reading";

/** How many joints are shown. */
const MAX_JOINTS = 200;
/** The range of a joint that no description has: half a turn each way, unless it turns further. */
const HALF_TURN = Math.PI;

/** The units of position, velocity and effort, by the type of a joint; others turn. */
const UNITS: Readonly<Record<string, readonly string[]>> = {
  prismatic: ["m", "m/s", "N"],
  revolute: ["rad", "rad/s", "Nm"],
};

interface Row {
  readonly element: HTMLElement;
  readonly bar: HTMLElement;
  readonly note: HTMLElement;
  /** Position, velocity and effort. */
  readonly cells: readonly HTMLElement[];
  values: readonly (number | undefined)[];
  low: number;
  high: number;
  /** Whether it turns on and on, so that no bar has room for it. */
  isEndless: boolean;
}

export class Joints implements Reading {
  readonly element: HTMLElement;
  readonly #body = h("tbody");
  readonly #rows = new KeyedRows(this.#body, (name: string) => this.#row(name));
  /** The names of joints so far, in the order of the rows. */
  #names: readonly string[] = [];
  readonly #more = h("p", { class: "soft small", hidden: true });
  /** Why there are no limits, if the description has a fault. */
  readonly #fault = h("p", { class: "soft small", hidden: true });
  /** The joints of the robot's description, by their names. */
  #joints = new Map<string, Joint>();

  /** The limits are those of `robot_description` in the topic's namespace, or in the root. */
  constructor(hub: DataSource, topic: string) {
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
      this.#fault,
    );
    void this.#loadLimits(hub, topic);
  }

  show(message: Message): void {
    const names = Array.isArray(message.name) ? message.name.map(String) : [];
    const unknown = names.filter((name) => this.#rows.get(name) === undefined);
    if (unknown.length > 0 && this.#names.length < MAX_JOINTS) {
      this.#names = [...new Set([...this.#names, ...unknown])]
        .slice(0, MAX_JOINTS)
        .sort((one, other) => one.localeCompare(other, undefined, { numeric: true }));
      this.#rows.show(this.#names);
    }
    names.forEach((name, at) => {
      const row = this.#rows.get(name);
      if (row === undefined) return;
      row.values = ["position", "velocity", "effort"].map((key) => {
        const value = own(own(message, key), String(at));
        return typeof value === "number" ? value : undefined;
      });
      this.#update(name, row);
    });
    const hidden = names.filter((name) => this.#rows.get(name) === undefined).length;
    this.#more.hidden = hidden === 0;
    setText(this.#more, `and ${plural(hidden, "more joint")}; only ${MAX_JOINTS} are shown`);
  }

  async #loadLimits(hub: DataSource, topic: string): Promise<void> {
    const parameters = new ParameterServer(hub);
    const namespace = topic.slice(0, topic.lastIndexOf("/"));
    for (const name of new Set([`${namespace}/robot_description`, "/robot_description"])) {
      // Nobody may read parameters here, or they are something else: bars have no limits then.
      const text = await parameters.get(name, "").catch(() => "");
      const urdf: unknown = JSON.parse(text || "null");
      if (typeof urdf !== "string" || urdf === "") continue;
      const { readUrdf } = await import("../scene/robot/urdf");
      try {
        this.#joints = new Map(readUrdf(urdf).joints.map((joint) => [joint.name, joint]));
      } catch (error) {
        setText(this.#fault, `No limits: ${name} is invalid: ${(error as Error).message}`);
        this.#fault.hidden = false;
      }
      for (const [joint, row] of this.#rows.entries()) {
        this.#setRange(joint, row);
        this.#update(joint, row);
      }
      return;
    }
  }

  #row(name: string): Row {
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
    const range = { low: -HALF_TURN, high: HALF_TURN, isEndless: false };
    const row: Row = { element, bar, note, cells, values: [], ...range };
    this.#setRange(name, row);
    return row;
  }

  #setRange(name: string, row: Row): void {
    const joint = this.#joints.get(name);
    if (joint === undefined) return;
    row.isEndless = !isLimited(joint);
    if (row.isEndless) return;
    row.low = joint.lower;
    row.high = joint.upper;
  }

  #update(name: string, row: Row): void {
    const { values } = row;
    const joint = this.#joints.get(name);
    const [position] = values;
    const units = joint === undefined ? [] : (UNITS[joint.type] ?? UNITS.revolute ?? []);
    row.cells.forEach((cell, at) => {
      const value = values[at];
      setText(cell, value === undefined ? "–" : `${fixedText(value, 3)} ${units[at] ?? ""}`.trim());
    });
    const limits = joint !== undefined && isLimited(joint) ? joint : undefined;
    if (position !== undefined && limits === undefined) {
      row.isEndless ||= Math.abs(position) > HALF_TURN;
    }
    const isBeyond =
      limits !== undefined &&
      position !== undefined &&
      (position < limits.lower || position > limits.upper);
    row.bar.classList.toggle("beyond", isBeyond);
    row.note.hidden = !isBeyond;
    row.bar.hidden = position === undefined || row.isEndless;
    if (position === undefined || row.isEndless) return;
    // The bar begins at zero, or at the end that is nearer to it.
    const part = (value: number): number =>
      Math.min(1, Math.max(0, (value - row.low) / (row.high - row.low)));
    const [from, to] = [part(0), part(position)].sort((one, other) => one - other) as [
      number,
      number,
    ];
    row.bar.style.setProperty("--from", `${(100 * from).toFixed(1)}%`);
    row.bar.style.setProperty("--length", `${(100 * (to - from)).toFixed(1)}%`);
    row.bar.title = limits === undefined ? "" : `${limits.lower} to ${limits.upper} ${units[0]}`;
  }
}

/** Whether a joint has a range that a bar can show. */
function isLimited({ lower, upper }: Joint): boolean {
  return Number.isFinite(lower) && Number.isFinite(upper) && lower < upper;
}
