/** The table of topics, kept up to date cell by cell. */
import { h, say } from "../dom";
import { bandwidth, hertz, plural, whole } from "../format";
import type { Model } from "../model";
import { plotButton } from "../tree/leaf";
import { route } from "../view";
import { type Column, type Order, type TopicRow, topicRows } from "./rows";

const COLUMNS: readonly { column: Column; label: string; number: boolean }[] = [
  { column: "name", label: "Topic", number: false },
  { column: "type", label: "Type", number: false },
  { column: "publishers", label: "Pubs", number: true },
  { column: "subscribers", label: "Subs", number: true },
  { column: "rate", label: "Rate", number: true },
  { column: "bandwidth", label: "Bandwidth", number: true },
  { column: "drops", label: "Drops", number: true },
];

interface Row {
  readonly element: HTMLTableRowElement;
  readonly link: HTMLAnchorElement;
  show(row: TopicRow): void;
}

export class TopicList {
  readonly element: HTMLElement;
  readonly #model: Model;
  readonly #plot: (topic: string, type: string) => void;
  readonly #body = h("tbody");
  readonly #heads = new Map<Column, HTMLTableCellElement>();
  readonly #filter: HTMLInputElement;
  readonly #debug: HTMLInputElement;
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #empty = h("p", { class: "empty" });
  readonly #rows = new Map<string, Row>();
  #order: Order = { column: "name", descending: false };
  #selected = "";
  #stops: (() => void)[] = [];

  /** `plot` is called for a topic of a type; `tools` stand beside the filter. */
  constructor(model: Model, plot: (topic: string, type: string) => void, ...tools: HTMLElement[]) {
    this.#model = model;
    this.#plot = plot;
    this.#filter = h("input", {
      type: "search",
      class: "grow",
      placeholder: "Filter by name or type",
      "aria-label": "Filter topics",
      oninput: () => this.#update(),
    });
    this.#debug = h("input", { type: "checkbox", onchange: () => this.#update() });
    const heads = COLUMNS.map(({ column, label, number }) => {
      const head = h(
        "th",
        { scope: "col", class: number ? `number col-${column}` : `col-${column}` },
        h("button", { type: "button", onclick: () => this.#sort(column, number) }, label),
      );
      this.#heads.set(column, head);
      return head;
    });
    this.element = h(
      "section",
      { class: "browse-list", "aria-label": "Topics" },
      h(
        "div",
        { class: "toolbar" },
        this.#filter,
        h("label", {}, this.#debug, "Debug"),
        ...tools,
        this.#count,
      ),
      h(
        "div",
        { class: "scroll" },
        h(
          "table",
          {},
          h(
            "thead",
            {},
            h(
              "tr",
              {},
              ...heads,
              h(
                "th",
                { scope: "col", class: "col-plot" },
                h("span", { class: "visually-hidden" }, "Plot"),
              ),
            ),
          ),
          this.#body,
        ),
        this.#empty,
      ),
    );
    this.#mark();
  }

  show(selected: string): void {
    this.#selected = selected;
    if (this.#stops.length === 0) {
      this.#stops = [
        this.#model.graph.watch(() => this.#update()),
        this.#model.rates.watch(() => this.#update()),
      ];
    }
    this.#select();
  }

  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
  }

  #sort(column: Column, number: boolean): void {
    const again = this.#order.column === column;
    // The largest numbers are what one looks for.
    this.#order = { column, descending: again ? !this.#order.descending : number };
    this.#mark();
    this.#update();
  }

  #mark(): void {
    for (const [column, head] of this.#heads) {
      if (column === this.#order.column)
        head.setAttribute("aria-sort", this.#order.descending ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    }
  }

  #update(): void {
    const graph = this.#model.graph.value;
    if (graph === null) {
      say(this.#empty, "Waiting for the hub …");
      return;
    }
    const rows = topicRows(
      graph,
      this.#model.rates.value,
      this.#filter.value.trim(),
      this.#debug.checked,
      this.#order,
    );
    const names = new Set(rows.map(({ name }) => name));
    for (const [name, row] of this.#rows) {
      if (names.has(name)) continue;
      row.element.remove();
      this.#rows.delete(name);
    }
    const focused = document.activeElement;
    let next = this.#body.firstElementChild;
    for (const row of rows) {
      let there = this.#rows.get(row.name);
      if (there === undefined) {
        there = this.#row(row.name);
        this.#rows.set(row.name, there);
      }
      there.show(row);
      if (there.element === next) next = next.nextElementSibling;
      else this.#body.insertBefore(there.element, next);
    }
    // What is moved loses the focus.
    if (
      focused instanceof HTMLElement &&
      focused !== document.activeElement &&
      this.#body.contains(focused)
    ) {
      focused.focus({ preventScroll: true });
    }
    this.#tell(rows.length, graph.topics.length);
  }

  #tell(shown: number, all: number): void {
    const filtered = this.#filter.value.trim() !== "";
    say(this.#count, plural(shown, "topic"));
    this.#empty.hidden = shown > 0;
    if (shown > 0) return;
    if (filtered) say(this.#empty, "No topic matches the filter.");
    else
      say(
        this.#empty,
        all === 0
          ? "There are no topics."
          : "No topics yet but the hub's own. Start a node, or make one with “New topic”.",
      );
  }

  #row(name: string): Row {
    const type = h("td", { class: "col-type" });
    const below = h("span", { class: "type-below" });
    const number = (column: Column): HTMLElement => h("td", { class: `number col-${column}` });
    const [publishers, subscribers] = [number("publishers"), number("subscribers")];
    const [rate, flow, drops] = [number("rate"), number("bandwidth"), number("drops")];
    const link = h("a", { href: route("topics", name) }, name);
    let typeName = "";
    const plot = plotButton(name, () => this.#plot(name, typeName));
    const element = h(
      "tr",
      {},
      h("th", { scope: "row", class: "col-name" }, link, below),
      type,
      publishers,
      subscribers,
      rate,
      flow,
      drops,
      h("td", { class: "col-plot" }, plot),
    );
    element.addEventListener("click", (event) => {
      // The whole row is a large target; the link is what the keyboard has.
      if (event.target instanceof Element && event.target.closest("a, button") === null)
        link.click();
    });
    const row: Row = {
      element,
      link,
      show: (topic) => {
        typeName = topic.type;
        say(type, topic.type === "" ? "–" : topic.type);
        say(below, topic.type);
        say(publishers, whole(topic.publishers));
        say(subscribers, whole(topic.subscribers));
        say(rate, topic.rate === 0 ? "–" : hertz(topic.rate));
        say(flow, topic.bandwidth === 0 ? "–" : bandwidth(topic.bandwidth));
        say(drops, topic.drops === 0 ? "–" : `${topic.dropping ? "⚠ " : ""}${whole(topic.drops)}`);
        plot.disabled = topic.type === "";
      },
    };
    if (name === this.#selected) link.setAttribute("aria-current", "true");
    return row;
  }

  #select(): void {
    for (const [name, { link }] of this.#rows) {
      if (name === this.#selected) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    }
    this.#rows.get(this.#selected)?.element.scrollIntoView({ block: "nearest" });
  }
}
