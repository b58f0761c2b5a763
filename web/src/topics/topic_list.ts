/** The table of topics: filtered, sorted, and updated cell by cell. */
import { followOnClick } from "../browse";
import { breakable, h, setName, setText } from "../dom";
import { type Filter, FilterInput, fieldsOf } from "../filter";
import { bandwidth, hertz, plural, whole } from "../format";
import { isHidden } from "../hidden_names";
import { KeyedRows } from "../keyed_rows";
import { plotButton } from "../message_tree";
import type { Graph, Model, Rates, TopicInfo } from "../model";
import { flowKey } from "../rates";
import { route } from "../view";

const COLUMNS: readonly { column: Column; label: string; number: boolean }[] = [
  { column: "name", label: "Topic", number: false },
  { column: "type", label: "Type", number: false },
  { column: "publishers", label: "Pubs", number: true },
  { column: "subscribers", label: "Subs", number: true },
  { column: "rate", label: "Rate", number: true },
  { column: "bandwidth", label: "Bandwidth", number: true },
  { column: "drops", label: "Drops", number: true },
];

/** A row of the table on the page. */
interface RowElement {
  readonly element: HTMLTableRowElement;
  readonly link: HTMLAnchorElement;
  show(row: TopicRow): void;
}

export class TopicList {
  readonly element: HTMLElement;
  readonly #model: Model;
  readonly #plot: (topic: string, type: string) => void;
  readonly #onChange: () => void;
  readonly #body = h("tbody");
  readonly #heads = new Map<Column, HTMLTableCellElement>();
  readonly #filter = new FilterInput("Filter topics", () => this.#changed());
  readonly #debug: HTMLInputElement;
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #empty = h("p", { class: "empty" });
  readonly #rows = new KeyedRows(this.#body, (name: string) => this.#createRow(name));
  #order: Order = { column: "name", descending: false };
  #selected = "";
  #stops: (() => void)[] = [];

  /**
   * `plot` is called with a topic and its type; `changed` when the state changes that belongs into
   * the URL. `tools` are placed beside the filter.
   */
  constructor(
    model: Model,
    plot: (topic: string, type: string) => void,
    changed: () => void,
    ...tools: (HTMLElement | null)[]
  ) {
    this.#model = model;
    this.#plot = plot;
    this.#onChange = changed;
    this.#debug = h("input", { type: "checkbox", onchange: () => this.#changed() });
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
        this.#filter.element,
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
    this.#markOrder();
  }

  show(selected: string, state: URLSearchParams | null): void {
    this.#selected = selected;
    if (state !== null) this.#restore(state);
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
    // Numbers start with the largest.
    this.#order = { column, descending: again ? !this.#order.descending : number };
    this.#markOrder();
    this.#changed();
  }

  #changed(): void {
    this.#onChange();
    this.#update();
  }

  /** The state that belongs into the URL: `?filter=scan&debug=1&sort=-rate`. */
  get state(): Record<string, string | boolean> {
    const { column, descending } = this.#order;
    return {
      filter: this.#filter.filter.text,
      debug: this.#debug.checked,
      sort: column === "name" && !descending ? "" : `${descending ? "-" : ""}${column}`,
    };
  }

  #restore(state: URLSearchParams): void {
    this.#filter.text = state.get("filter") ?? "";
    this.#debug.checked = state.has("debug");
    const sort = state.get("sort") ?? "";
    const column = COLUMNS.find((each) => each.column === sort.replace(/^-/, ""))?.column;
    this.#order = {
      column: column ?? "name",
      descending: column !== undefined && sort.startsWith("-"),
    };
    this.#markOrder();
    this.#update();
  }

  #markOrder(): void {
    for (const [column, head] of this.#heads) {
      if (column === this.#order.column)
        head.setAttribute("aria-sort", this.#order.descending ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    }
  }

  #update(): void {
    const graph = this.#model.graph.value;
    if (graph === null) {
      setText(this.#empty, "Waiting for the hub …");
      return;
    }
    const rows = topicRows(
      graph,
      this.#model.rates.value,
      this.#filter.filter,
      this.#debug.checked,
      this.#order,
    );
    this.#rows.show(rows.map(({ name }) => name));
    for (const row of rows) this.#rows.get(row.name)?.show(row);
    this.#showCount(rows.length, graph.topics.length);
  }

  #showCount(shown: number, total: number): void {
    setText(this.#count, plural(shown, "topic"));
    this.#empty.hidden = shown > 0;
    if (shown > 0) return;
    if (!this.#filter.filter.isEmpty) setText(this.#empty, "No topics match the filter.");
    else
      setText(
        this.#empty,
        total === 0
          ? "There are no topics."
          : "No topics besides the hub's own. Start a node, or create one with “New topic”.",
      );
  }

  #createRow(name: string): RowElement {
    const type = h("td", { class: "col-type" });
    const below = h("span", { class: "type-below ros-name" });
    const number = (column: Column): HTMLElement => h("td", { class: `number col-${column}` });
    const [publishers, subscribers] = [number("publishers"), number("subscribers")];
    const [rate, flow, drops] = [number("rate"), number("bandwidth"), number("drops")];
    const link = h(
      "a",
      { href: route("topics", name), class: "ros-name", title: name },
      ...breakable(name),
    );
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
    followOnClick(element, link);
    if (name === this.#selected) link.setAttribute("aria-current", "true");
    return {
      element,
      link,
      show: (topic) => {
        typeName = topic.type;
        setName(type, topic.type === "" ? "–" : topic.type);
        setName(below, topic.type);
        setText(publishers, whole(topic.publishers));
        setText(subscribers, whole(topic.subscribers));
        setText(rate, topic.rate === 0 ? "–" : hertz(topic.rate));
        setText(flow, topic.bandwidth === 0 ? "–" : bandwidth(topic.bandwidth));
        setText(
          drops,
          topic.drops === 0 ? "–" : `${topic.dropping ? "⚠ " : ""}${whole(topic.drops)}`,
        );
        plot.disabled = topic.type === "";
      },
    };
  }

  #select(): void {
    for (const [name, { link }] of this.#rows.entries()) {
      if (name === this.#selected) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    }
    this.#rows.get(this.#selected)?.element.scrollIntoView({ block: "nearest" });
  }
}

/** The cells of one topic. */
export interface TopicRow {
  readonly name: string;
  readonly type: string;
  readonly publishers: number;
  readonly subscribers: number;
  /** Messages a second. */
  readonly rate: number;
  /** Bytes a second. */
  readonly bandwidth: number;
  /** Messages dropped for its current subscribers. */
  readonly drops: number;
  /** Whether messages are dropped now. */
  readonly dropping: boolean;
}

export type Column = keyof Omit<TopicRow, "dropping">;

export interface Order {
  readonly column: Column;
  readonly descending: boolean;
}

export function topicRow(topic: TopicInfo, rates: Rates): TopicRow {
  const flow = rates.topics.get(topic.name);
  const drops = topic.subscriptions.reduce(
    (sum, { node }) => sum + (rates.dropped.get(flowKey(topic.name, node)) ?? 0),
    0,
  );
  return {
    name: topic.name,
    type: topic.type,
    publishers: topic.publishers.length,
    subscribers: topic.subscriptions.length,
    rate: flow?.messages ?? 0,
    bandwidth: flow?.bytes ?? 0,
    drops,
    dropping: (flow?.dropped ?? 0) > 0,
  };
}

/** The rows that match a filter, in order; hidden names only with `debug`. */
export function topicRows(
  graph: Graph,
  rates: Rates,
  filter: Filter,
  debug: boolean,
  order: Order,
): TopicRow[] {
  const isShown = (name: string): boolean => debug || !isHidden(name);
  const nodesOf = (topic: TopicInfo): string[][] =>
    [...topic.publishers, ...topic.subscriptions]
      .filter(({ node }) => isShown(node))
      .map(({ node }) => fieldsOf({ name: node }));
  return graph.topics
    .filter((topic) => isShown(topic.name) && filter.shows(fieldsOf(topic), nodesOf(topic)))
    .map((topic) => topicRow(topic, rates))
    .sort((one, other) => compare(one, other, order));
}

function compare(one: TopicRow, other: TopicRow, { column, descending }: Order): number {
  const [a, b] = [one[column], other[column]];
  const direction = descending ? -1 : 1;
  if (a !== b) return a < b ? -direction : direction;
  return one.name < other.name ? -1 : 1;
}
