/** Shows diagnostics as rqt_robot_monitor does: a tree, the worst first, and what has changed. */
import "./diagnostics.css";

import { h, replace, setAttribute, setText } from "../../dom";
import { plural, timeOfDay } from "../../format";
import { KeyedRows } from "../../keyed_rows";
import { subscribe } from "../../messages/data_client";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import type { Config, Panel } from "../panel";
import {
  DiagnosticsTree,
  type Item,
  type Level,
  MAX_ITEMS,
  matches,
  type Status,
  sorted,
} from "./tree";

/** Time between two updates, in ms. */
const TICK = 250;
/** How many messages wait: each may be about other devices. */
const QUEUE = 1000;
/** Longer texts are cut. */
const MAX_TEXT = 5000;
const MAX_VALUES = 500;
/** A sign for each level, besides its colour, and its word. */
const SIGNS: Record<Level, readonly [sign: string, word: string]> = {
  ok: ["✓", "OK"],
  warn: ["!", "Warning"],
  error: ["✗", "Error"],
  stale: ["?", "Stale"],
};

export function makePanel(
  hub: DataSource,
  _model: Model,
  topic: string,
  _type: string,
  config?: Config,
): Panel {
  return new DiagnosticsPanel(hub, topic, config);
}

/** One item on the page. */
interface Row {
  readonly element: HTMLDetailsElement;
  readonly sign: HTMLElement;
  readonly message: HTMLElement;
  readonly facts: HTMLElement;
  readonly children: Rows;
  shown: Status | undefined;
}

/** The items below another one, by their paths. */
type Rows = KeyedRows<Item, Row, string>;

class DiagnosticsPanel implements Panel {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #topic: string;
  #tree = new DiagnosticsTree();
  readonly #counts = h("p", { class: "diagnostics-counts", role: "status" });
  readonly #filter = h("input", {
    type: "search",
    class: "grow",
    placeholder: "Filter",
    "aria-label": "Filter diagnostics",
    oninput: () => this.#show(),
  });
  readonly #list = h("div", { class: "diagnostics-tree" });
  readonly #rows = this.#rowsIn(this.#list);
  readonly #changes = h("ol", { class: "plain diagnostics-changes small" });
  readonly #history = h("details", {}, h("summary", {}, "Changes"), this.#changes);
  readonly #empty = h("p", { class: "soft" }, "No message yet.");
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  #stop: (() => void) | undefined;
  #timer: number | undefined;
  #isNew = false;

  constructor(hub: DataSource, topic: string, config?: Config) {
    this.#hub = hub;
    this.#topic = topic;
    if (typeof config?.filter === "string") this.#filter.value = config.filter;
    this.element = h(
      "div",
      { class: "diagnostics" },
      h("div", { class: "toolbar" }, this.#counts, this.#filter),
      this.#error,
      this.#empty,
      this.#list,
      this.#history,
    );
  }

  show(): void {
    if (this.#stop !== undefined) return;
    const unwatch = this.#hub.clock.onJump(() => {
      this.#tree = new DiagnosticsTree();
      this.#isNew = true;
    });
    const unsubscribe = subscribe(
      this.#hub,
      { topic: this.#topic, queue: QUEUE },
      (message, { time }) => {
        this.#tree.update(message.status as Status[], time);
        this.#isNew = true;
      },
      (why) => {
        setText(this.#error, why);
        this.#error.hidden = why === "";
      },
    );
    this.#stop = () => {
      unwatch();
      unsubscribe();
    };
    let before = 0;
    this.#timer = window.setInterval(() => {
      // Statuses become stale without a message.
      const now = this.#hub.clock.now();
      if (!this.#isNew && now - before < 1000) return;
      before = now;
      this.#isNew = false;
      this.#tree.age(now);
      this.#show();
    }, TICK);
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    window.clearInterval(this.#timer);
  }

  config(): Config {
    return this.#filter.value === "" ? {} : { filter: this.#filter.value };
  }

  #show(): void {
    const { root, counts, changes, isFull } = this.#tree;
    const isEmpty = root.children.size === 0;
    this.#empty.hidden = !isEmpty;
    const texts = [
      plural(counts.error, "error"),
      plural(counts.warn, "warning"),
      `${counts.stale} stale`,
      `${counts.ok} OK`,
      ...(isFull ? [`only ${MAX_ITEMS} are shown`] : []),
    ];
    setText(this.#counts, isEmpty ? "" : texts.join(" · "));
    this.#showChildren(this.#rows, root, this.#filter.value.trim().toLowerCase());
    this.#history.hidden = changes.length === 0;
    if (this.#history.open) {
      replace(
        this.#changes,
        ...changes.map(({ time, name, from, to, message }) =>
          h(
            "li",
            {},
            h("time", { class: "mono" }, timeOfDay(time / 1000)),
            ` ${cut(name)}: ${SIGNS[from][1]} → `,
            h("b", { class: `level-${to}` }, SIGNS[to][1]),
            ` ${cut(message)}`,
          ),
        ),
      );
    }
  }

  #showChildren(rows: Rows, item: Item, filter: string): void {
    const shown = sorted(item).filter((child) => filter === "" || matches(child, filter));
    rows.show(shown);
    for (const child of shown) {
      const row = rows.get(child.path);
      if (row === undefined) continue;
      this.#update(row, child);
      // What is below an item that matches itself belongs to it.
      const isWhole = filter !== "" && child.path.toLowerCase().includes(filter);
      this.#showChildren(row.children, child, isWhole ? "" : filter);
    }
  }

  #rowsIn(parent: HTMLElement): Rows {
    return new KeyedRows(
      parent,
      (item) => this.#row(item),
      ({ path }) => path,
    );
  }

  #row({ label, level }: Item): Row {
    const sign = h("span", { class: "diagnostics-sign" });
    const message = h("span", { class: "soft diagnostics-message" });
    const facts = h("div", { class: "diagnostics-facts" });
    const below = h("div", { class: "diagnostics-children" });
    const element = h(
      "details",
      { open: level !== "ok" },
      h("summary", {}, sign, " ", h("b", {}, cut(label)), " ", message),
      facts,
      below,
    );
    const children = this.#rowsIn(below);
    return { element, sign, message, facts, children, shown: undefined };
  }

  #update(row: Row, { level, status }: Item): void {
    const [sign, word] = SIGNS[level];
    if (setAttribute(row.element, "class", `level-${level}`)) {
      replace(row.sign, sign, h("span", { class: "visually-hidden" }, word));
    }
    setText(row.message, cut(status?.message ?? ""));
    if (status === row.shown || status === undefined) return;
    row.shown = status;
    if (!row.element.open) {
      // The values are not made until somebody looks at them.
      row.element.ontoggle = () => row.shown && showFacts(row.facts, row.shown);
      return;
    }
    showFacts(row.facts, status);
  }
}

function showFacts(element: HTMLElement, { hardware_id, values }: Status): void {
  const rows = [
    ...(hardware_id === "" ? [] : [["hardware id", hardware_id] as const]),
    ...values.slice(0, MAX_VALUES).map(({ key, value }) => [key, value] as const),
  ];
  const more = values.length - MAX_VALUES;
  replace(
    element,
    rows.length === 0
      ? null
      : h(
          "table",
          {},
          ...rows.map(([key, value]) =>
            h(
              "tr",
              {},
              h("th", { scope: "row" }, cut(key)),
              h("td", { class: "mono" }, cut(value)),
            ),
          ),
        ),
    more > 0 && h("p", { class: "soft small" }, `and ${plural(more, "value")} more`),
  );
}

function cut(text: string): string {
  return text.length > MAX_TEXT ? `${text.slice(0, MAX_TEXT)} …` : text;
}
