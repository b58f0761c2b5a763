/** The panel with the details of one element, beside the drawing. */

import { breakable, type Child, h, replace, setName, setText } from "../dom";
import { ago, bandwidth, bytes, dateTime, hertz, whole } from "../format";
import type {
  ActionInfo,
  ClientStatistics,
  Graph,
  Model,
  NodeInfo,
  Rates,
  ServiceInfo,
  TopicInfo,
} from "../model";
import { flowKey } from "../rates";
import { definitions } from "../type_definition";
import type { TypeDef } from "../types";
import { route } from "../view";
import { conflictText, TopicUsers } from "./conflicts";
import type { Kind } from "./picture";

const NOT_COUNTED =
  "ROS 1 nodes send each other messages directly: the hub sees and counts only those to and from " +
  "its own clients.";

type Live = (rates: Rates, clients: readonly ClientStatistics[]) => void;

export class Details {
  readonly element: HTMLElement;
  readonly #title = h("h2", { tabindex: -1 });
  readonly #kind = h("span", { class: "soft small" });
  readonly #body = h("div", { class: "body" });
  readonly #model: Model;
  #live: Live[] = [];
  #shown: { kind: Kind; name: string } | null = null;
  #drawn = "";

  /** `close` is called when the user closes the panel. */
  constructor(model: Model, close: () => void) {
    this.#model = model;
    this.element = h(
      "aside",
      {
        class: "details",
        "aria-label": "Details",
        hidden: true,
      },
      h(
        "header",
        {},
        h("div", {}, this.#kind, this.#title),
        h(
          "button",
          {
            class: "icon",
            "aria-label": "Close the details",
            title: "Close (Esc)",
            onclick: close,
          },
          "✕",
        ),
      ),
      this.#body,
    );
  }

  /** Show the details of an element; null closes the panel. */
  show(shown: { kind: Kind; name: string } | null): void {
    this.#shown = shown;
    this.#drawn = "";
    this.element.hidden = shown === null;
    this.update(this.#model.graph.value);
  }

  /** The size of the part of the drawing that it covers, in pixels. */
  covered(): { width: number; height: number } {
    const { hidden, offsetWidth, offsetHeight, parentElement } = this.element;
    if (hidden || parentElement === null) return { width: 0, height: 0 };
    const isFullWidth = offsetWidth >= parentElement.offsetWidth;
    return isFullWidth ? { width: 0, height: offsetHeight } : { width: offsetWidth, height: 0 };
  }

  /** Show the current graph. */
  update(graph: Graph | null): void {
    const shown = this.#shown;
    if (shown === null || graph === null) return;
    const known = elementData(graph, shown);
    // Unchanged details are not drawn again: folds and selected text stay.
    const drawn = JSON.stringify([shown, known]);
    if (drawn === this.#drawn) return;
    this.#drawn = drawn;
    this.#live = [];
    const hasFocus = this.#body.contains(document.activeElement);
    replace(this.#kind, shown.kind);
    setName(this.#title, shown.name);
    replace(this.#body, ...this.#describe(shown.name, known));
    this.updateNumbers();
    // The focused link was replaced.
    if (hasFocus) this.#title.focus();
  }

  /** Update the numbers. */
  updateNumbers(): void {
    for (const update of this.#live) update(this.#model.rates.value, this.#model.clients.value);
  }

  #describe(name: string, known: ElementData | undefined): Child[] {
    switch (known?.kind) {
      case "node":
        return this.#node(known);
      case "topic":
        return this.#topic(known.topic, known.direct);
      case "service":
        return this.#service(known.service);
      case "action":
        return this.#action(known.action, known.topics);
      case undefined:
        return [h("p", { class: "soft" }, `${name} is not in the graph.`)];
    }
  }

  #node({
    node,
    publishes,
    subscribes,
    conflicts,
    actions,
    services,
  }: ElementData & { kind: "node" }): Child[] {
    const isRos1 = node.api !== "";
    const since = node.since.secs + node.since.nsecs / 1e9;
    const queued = this.#liveText((_, clients) => {
      const client = clients.find((each) => each.node === node.name);
      if (client === undefined) return "–";
      const slow = client.slow ? ", slow: its socket accepts no data now" : "";
      return `${bytes(client.kept_bytes)} queued, ${whole(client.dropped)} dropped${slow}`;
    });
    const key = (topic: string): string => flowKey(topic, node.name);
    return [
      terms([
        isRos1 ? ["kind", "ROS 1 node"] : null,
        node.hub === ""
          ? ["address", node.api || node.address || (node.own ? "part of the hub" : "unknown")]
          : ["hub", node.hub],
        node.fault === "" ? null : ["state", warning(`unreachable: ${node.fault}`)],
        [
          "since",
          this.#liveText(
            () => `${dateTime(node.since.secs, 0).slice(0, 19)}, ${ago(Date.now() / 1000 - since)}`,
          ),
        ],
        node.own || isRos1 || node.hub !== "" ? null : ["send queue", queued],
      ]),
      isRos1 ? h("p", { class: "soft small" }, NOT_COUNTED) : null,
      list(
        "Conflicts",
        conflicts.map(({ topic, text }) => [
          h("span", {}, link("topic", topic), h("span", {}, warning(text))),
        ]),
      ),
      list(
        "Publishes",
        publishes.map((topic) => [
          link("topic", topic),
          this.#liveText((rates) => hertz(rates.publishers.get(key(topic))?.messages ?? 0)),
        ]),
      ),
      list(
        "Subscribes",
        subscribes.map((topic) => [
          link("topic", topic),
          this.#liveText((rates) => hertz(rates.subscriptions.get(key(topic))?.messages ?? 0)),
        ]),
      ),
      list(
        "Actions",
        actions.map((action) => [link("action", action)]),
      ),
      list(
        "Services",
        services.map((service) => [link("service", service)]),
      ),
    ];
  }

  #topic(topic: TopicInfo, direct: boolean): Child[] {
    const { name } = topic;
    const key = (node: string): string => flowKey(name, node);
    const flowing = this.#liveText((rates) => {
      const flow = rates.topics.get(name);
      return `${hertz(flow?.messages ?? 0)}, ${bandwidth(flow?.bytes ?? 0)}`;
    });
    return [
      h(
        "p",
        { class: "links" },
        h("a", { class: "button", href: route("topics", name) }, "echo"),
        h("a", { class: "button", href: route("topics", name, "plot") }, "plot"),
      ),
      terms([
        ["type", h("code", {}, ...breakable(topic.type || "unknown"))],
        topic.checked || topic.type === ""
          ? null
          : ["checked", "no, the hub does not know this type"],
        ["rate", flowing],
      ]),
      direct ? h("p", { class: "soft small" }, NOT_COUNTED) : null,
      list(
        "Conflicts",
        topic.conflicts.map((conflict) => [
          h(
            "span",
            { title: conflict.fault },
            link("node", conflict.node),
            h("span", {}, warning(conflictText(conflict, topic))),
          ),
        ]),
      ),
      list(
        "Publishers",
        topic.publishers.map(({ node, latch }) => [
          h(
            "span",
            {},
            link("node", node),
            latch ? h("span", { class: "badge" }, "latched") : null,
          ),
          this.#liveText((rates) => {
            const flow = rates.publishers.get(key(node));
            return `${hertz(flow?.messages ?? 0)}, ${bandwidth(flow?.bytes ?? 0)}`;
          }),
        ]),
        "no publishers",
      ),
      list(
        "Subscribers",
        topic.subscriptions.map(({ node, queue_length, throttle_rate, compression }) => [
          h(
            "span",
            {},
            link("node", node),
            h(
              "span",
              { class: "soft small" },
              [
                queue_length > 0 ? `queue of ${queue_length}` : "unlimited queue",
                throttle_rate > 0 ? `at most every ${throttle_rate} ms` : "not throttled",
                compression === "none" || compression === "" ? "" : compression,
              ]
                .filter((part) => part !== "")
                .join(", "),
            ),
          ),
          this.#liveText((rates) => {
            const dropped = rates.dropped.get(key(node)) ?? 0;
            const rate = hertz(rates.subscriptions.get(key(node))?.messages ?? 0);
            return dropped > 0 ? `${rate}, ⚠ ${whole(dropped)} dropped` : rate;
          }),
        ]),
        "no subscribers",
      ),
      this.#definition(topic.type, "Definition", (type) => this.#model.typedefs(type)),
    ];
  }

  #service({ name, type, node }: ServiceInfo): Child[] {
    return [
      h(
        "p",
        { class: "links" },
        h("a", { class: "button", href: route("services", name) }, "call"),
      ),
      terms([
        ["type", h("code", {}, type)],
        ["node", link("node", node)],
      ]),
      this.#definition(type, "Request", (each) => this.#model.requestTypedefs(each)),
      this.#definition(type, "Response", (each) => this.#model.responseTypedefs(each)),
    ];
  }

  #action({ name, type, node, over_topics }: ActionInfo, topics: readonly string[]): Child[] {
    return [
      h(
        "p",
        { class: "links" },
        h("a", { class: "button", href: route("actions", name) }, "send a goal"),
      ),
      terms([
        ["type", h("code", {}, type)],
        ["server", link("node", node)],
        ["transport", over_topics ? "five topics, as in ROS 1" : "operations, as in ROS 2"],
      ]),
      list(
        "Topics",
        topics.map((topic) => [
          link("topic", topic),
          this.#liveText((rates) => hertz(rates.topics.get(topic)?.messages ?? 0)),
        ]),
      ),
    ];
  }

  /** The definition of a type, loaded on demand. */
  #definition(type: string, title: string, load: (type: string) => Promise<TypeDef[]>): Child {
    if (type === "") return null;
    const place = h(
      "section",
      {},
      h("h3", {}, title),
      h("p", { class: "soft small" }, "loading …"),
    );
    load(type).then(
      (typedefs) => replace(place, h("h3", {}, title), ...definitions(typedefs)),
      (error: Error) =>
        replace(place, h("h3", {}, title), h("p", { class: "soft small" }, error.message)),
    );
    return place;
  }

  /** A text that is updated with the rates. */
  #liveText(text: (rates: Rates, clients: readonly ClientStatistics[]) => string): HTMLElement {
    const place = h("span", { class: "live" });
    this.#live.push((rates, clients) => setText(place, text(rates, clients)));
    return place;
  }
}

function link(kind: Kind, name: string): HTMLElement {
  return h("a", { href: route("graph", kind, name), title: name }, ...breakable(name));
}

function terms(rows: ([string, Child] | null)[]): HTMLElement {
  return h(
    "dl",
    {},
    ...rows.flatMap((row) => (row === null ? [] : [h("dt", {}, row[0]), h("dd", {}, row[1])])),
  );
}

function list(title: string, rows: Child[][], none?: string): Child {
  if (rows.length === 0) {
    if (none === undefined) return null;
    return h("section", {}, h("h3", {}, title), h("p", { class: "soft small" }, none));
  }
  return h(
    "section",
    {},
    h("h3", {}, `${title} `, h("span", { class: "soft" }, rows.length)),
    h("ul", {}, ...rows.map((cells) => h("li", {}, ...cells))),
  );
}

const warning = (text: string): HTMLElement => h("span", { class: "warning" }, `⚠ ${text}`);

export type ElementData =
  | {
      kind: "node";
      node: NodeInfo;
      /** Names of topics. */
      publishes: string[];
      subscribes: string[];
      /** Topics on which it exchanges no messages with the hub's clients, and why. */
      conflicts: { topic: string; text: string }[];
      actions: string[];
      services: string[];
    }
  /** `direct`: whether ROS 1 nodes exchange messages of it without the hub. */
  | { kind: "topic"; topic: TopicInfo; direct: boolean }
  | { kind: "service"; service: ServiceInfo }
  /** `topics` are its own ones, if it is over topics. */
  | { kind: "action"; action: ActionInfo; topics: string[] };

/** The data of one element, if it is in the graph: its details change only with these. */
export function elementData(
  graph: Graph,
  { kind, name }: { kind: Kind; name: string },
): ElementData | undefined {
  const named = (each: { name: string }): boolean => each.name === name;
  const its = (each: { node: string }): boolean => each.node === name;
  switch (kind) {
    case "node": {
      const node = graph.nodes.find(named);
      return (
        node && {
          kind,
          node,
          publishes: names(graph.topics.filter(({ publishers }) => publishers.some(its))),
          subscribes: names(graph.topics.filter(({ subscriptions }) => subscriptions.some(its))),
          conflicts: graph.topics.flatMap((topic) =>
            topic.conflicts
              .filter(its)
              .map((conflict) => ({ topic: topic.name, text: conflictText(conflict, topic) })),
          ),
          actions: names(graph.actions.filter(its)),
          services: names(graph.services.filter(its)),
        }
      );
    }
    case "topic": {
      const topic = graph.topics.find(named);
      return topic && { kind, topic, direct: new TopicUsers(graph).isDirect(topic) };
    }
    case "service": {
      const service = graph.services.find(named);
      return service && { kind, service };
    }
    case "action": {
      const action = graph.actions.find(named);
      const topics = action?.over_topics ? names(graph.topics) : [];
      return (
        action && { kind, action, topics: topics.filter((topic) => topic.startsWith(`${name}/`)) }
      );
    }
  }
}

const names = (all: readonly { name: string }[]): string[] => all.map(({ name }) => name);
