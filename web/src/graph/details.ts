// What is to be known of one element, beside the drawing.

import { definitions } from "../definition";
import { type Child, h, replace, say } from "../dom";
import { ago, bandwidth, bytes, hertz, moment, whole } from "../format";
import type {
  ActionInfo,
  ClientStatistics,
  Graph,
  Model,
  Rates,
  ServiceInfo,
  TopicInfo,
} from "../model";
import { flowKey } from "../rates";
import type { TypeDef } from "../types";
import { route } from "../view";
import { type Facts, facts } from "./facts";
import type { Kind } from "./picture";

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

  /** `close` is called when its reader has had enough. */
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

  /** Show an element, or with null none. */
  show(shown: { kind: Kind; name: string } | null): void {
    this.#shown = shown;
    this.#drawn = "";
    this.element.hidden = shown === null;
    this.follow(this.#model.graph.value);
  }

  /** How much of the drawing lies under it, in pixels. */
  covers(): { width: number; height: number } {
    const { hidden, offsetWidth, offsetHeight, parentElement } = this.element;
    if (hidden || parentElement === null) return { width: 0, height: 0 };
    const below = offsetWidth >= parentElement.offsetWidth;
    return below ? { width: 0, height: offsetHeight } : { width: offsetWidth, height: 0 };
  }

  /** The graph has changed. */
  follow(graph: Graph | null): void {
    const shown = this.#shown;
    if (shown === null || graph === null) return;
    const known = facts(graph, shown);
    // What is open or marked in the details stays so until they say something else.
    const drawn = JSON.stringify([shown, known]);
    if (drawn === this.#drawn) return;
    this.#drawn = drawn;
    this.#live = [];
    const reading = this.#body.contains(document.activeElement);
    replace(this.#kind, shown.kind);
    replace(this.#title, shown.name);
    replace(this.#body, ...this.#describe(shown.name, known));
    this.measure();
    // The link that was followed is gone, and the keyboard with it.
    if (reading) this.#title.focus();
  }

  /** Bring the numbers up to date. */
  measure(): void {
    for (const tell of this.#live) tell(this.#model.rates.value, this.#model.clients.value);
  }

  #describe(name: string, known: Facts | undefined): Child[] {
    switch (known?.kind) {
      case "node":
        return this.#node(known);
      case "topic":
        return this.#topic(known.topic);
      case "service":
        return this.#service(known.service);
      case "action":
        return this.#action(known.action, known.topics);
      case undefined:
        return [h("p", { class: "soft" }, `${name} is not in the graph now.`)];
    }
  }

  #node({ node, publishes, subscribes, actions, services }: Facts & { kind: "node" }): Child[] {
    const since = node.since.secs + node.since.nsecs / 1e9;
    const kept = this.#lively((_, clients) => {
      const client = clients.find((each) => each.node === node.name);
      if (client === undefined) return "–";
      const slow = client.slow ? ", slow: its socket takes no more now" : "";
      return `${bytes(client.kept_bytes)} waiting, ${whole(client.dropped)} dropped${slow}`;
    });
    const key = (topic: string): string => flowKey(topic, node.name);
    return [
      terms([
        ["address", node.address || (node.own ? "the hub itself" : "unknown")],
        [
          "since",
          this.#lively(
            () => `${moment(node.since.secs, 0).slice(0, 19)}, ${ago(Date.now() / 1000 - since)}`,
          ),
        ],
        node.own ? null : ["outbox", kept],
      ]),
      list(
        "Publishes",
        publishes.map((topic) => [
          link("topic", topic),
          this.#lively((rates) => hertz(rates.publishers.get(key(topic))?.messages ?? 0)),
        ]),
      ),
      list(
        "Subscribes",
        subscribes.map((topic) => [
          link("topic", topic),
          this.#lively((rates) => hertz(rates.subscriptions.get(key(topic))?.messages ?? 0)),
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

  #topic(topic: TopicInfo): Child[] {
    const { name } = topic;
    const key = (node: string): string => flowKey(name, node);
    const flowing = this.#lively((rates) => {
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
        ["type", h("code", {}, topic.type || "none yet")],
        topic.checked || topic.type === ""
          ? null
          : ["checked", "no: the hub does not know this type"],
        ["flow", flowing],
      ]),
      list(
        "Publishers",
        topic.publishers.map(({ node, latch }) => [
          h(
            "span",
            {},
            link("node", node),
            latch ? h("span", { class: "badge" }, "latched") : null,
          ),
          this.#lively((rates) => {
            const flow = rates.publishers.get(key(node));
            return `${hertz(flow?.messages ?? 0)}, ${bandwidth(flow?.bytes ?? 0)}`;
          }),
        ]),
        "none: nobody publishes here",
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
                queue_length > 0 ? `queue of ${queue_length}` : "no queue length",
                throttle_rate > 0 ? `one in ${throttle_rate} ms at most` : "not throttled",
                compression === "none" || compression === "" ? "" : compression,
              ]
                .filter((part) => part !== "")
                .join(", "),
            ),
          ),
          this.#lively((rates) => {
            const dropped = rates.dropped.get(key(node)) ?? 0;
            const rate = hertz(rates.subscriptions.get(key(node))?.messages ?? 0);
            return dropped > 0 ? `${rate}, ⚠ ${whole(dropped)} dropped` : rate;
          }),
        ]),
        "none: nobody listens",
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

  #action({ type, node, over_topics }: ActionInfo, topics: readonly string[]): Child[] {
    return [
      terms([
        ["type", h("code", {}, type)],
        ["server", link("node", node)],
        ["carried by", over_topics ? "five topics, as in ROS 1" : "operations, as in ROS 2"],
      ]),
      list(
        "Topics",
        topics.map((topic) => [
          link("topic", topic),
          this.#lively((rates) => hertz(rates.topics.get(topic)?.messages ?? 0)),
        ]),
      ),
    ];
  }

  /** A type as .msg text; the types in it are folded. */
  #definition(type: string, title: string, ask: (type: string) => Promise<TypeDef[]>): Child {
    if (type === "") return null;
    const place = h("section", {}, h("h3", {}, title), h("p", { class: "soft small" }, "asking …"));
    ask(type).then(
      (typedefs) => replace(place, h("h3", {}, title), ...definitions(typedefs)),
      (error: Error) =>
        replace(place, h("h3", {}, title), h("p", { class: "soft small" }, error.message)),
    );
    return place;
  }

  /** A text that is made anew with each answer of the hub's. */
  #lively(text: (rates: Rates, clients: readonly ClientStatistics[]) => string): HTMLElement {
    const place = h("span", { class: "live" });
    this.#live.push((rates, clients) => say(place, text(rates, clients)));
    return place;
  }
}

function link(kind: Kind, name: string): HTMLElement {
  return h("a", { href: route("graph", kind, name) }, name);
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
