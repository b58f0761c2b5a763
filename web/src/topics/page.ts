/** All about one topic: its newest message, a form to publish, who is connected, and its type. */
import { definitions } from "../definition";
import { h, replace, say } from "../dom";
import { bandwidth, hertz, plural } from "../format";
import type { Hub } from "../hub";
import type { Model, TopicInfo } from "../model";
import { type TypeDef, Types } from "../types";
import { route } from "../view";
import { Echo } from "./echo";
import type { Plot } from "./plot";
import { Publish } from "./publish";
import { topicRow } from "./rows";

export class TopicPage {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #model: Model;
  readonly #plot: Plot;
  readonly #name: string;
  readonly #expected: string;
  readonly #type = h("code", { class: "soft" });
  readonly #flow = h("p", { class: "soft small topic-flow" });
  readonly #notice = h("p", { class: "notice", role: "status", hidden: true });
  readonly #picker = h("div");
  readonly #echo = section("Echo", true);
  readonly #publish = section("Publish", false);
  readonly #connections = section("Connections", true);
  readonly #definition = section("Type", false);
  /** The type that the tools below are made for. */
  #made = "";
  /** Why nothing is known of that type; empty if it is. */
  #unknown = "";
  #tools: { echo: Echo; publish: Publish | undefined } | undefined;
  #connected = "";
  #stops: (() => void)[] = [];

  /** `expected` is the type that the topic will have if it is not there yet. */
  constructor(hub: Hub, model: Model, plot: Plot, name: string, expected: string) {
    this.#hub = hub;
    this.#model = model;
    this.#plot = plot;
    this.#name = name;
    this.#expected = expected;
    this.element = h(
      "article",
      { class: "browse-page", "aria-label": name },
      h(
        "header",
        {},
        h("h2", { class: "mono" }, name),
        h(
          "a",
          {
            class: "button close",
            href: route("topics"),
            "aria-label": "Close, back to all topics",
          },
          "×",
        ),
      ),
      this.#type,
      this.#flow,
      this.#notice,
      this.#picker,
      this.#echo.element,
      this.#publish.element,
      this.#connections.element,
      this.#definition.element,
    );
    this.#echo.element.addEventListener("toggle", () => this.#showEcho());
  }

  /** Comes into sight. */
  show(): void {
    if (this.#stops.length > 0) return;
    this.#stops = [
      this.#model.graph.watch(() => this.#update()),
      this.#model.rates.watch(() => this.#measure()),
    ];
    this.#showEcho();
  }

  /** Goes out of sight: nothing is heard or published any more. */
  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
    this.#tools?.echo.hide();
    this.#tools?.publish?.close();
  }

  get #topic(): TopicInfo | undefined {
    return this.#model.graph.value?.topics.find(({ name }) => name === this.#name);
  }

  #update(): void {
    const topic = this.#topic;
    const type = topic?.type || this.#expected;
    this.#connect(topic);
    this.#measure();
    const notice = this.#noticeOf(topic, type);
    say(this.#notice, notice);
    this.#notice.hidden = notice === "";
    if (type !== "" && type !== this.#made) void this.#make(type, topic === undefined);
  }

  #noticeOf(topic: TopicInfo | undefined, type: string): string {
    if (this.#unknown !== "") return this.#unknown;
    if (type === "") {
      return this.#model.graph.value === null
        ? "Waiting for the hub …"
        : "There is no such topic now. It shows here as soon as a node publishes it.";
    }
    return topic === undefined
      ? "This topic is not there yet: the first message that you publish makes it."
      : "";
  }

  /** The tools for a type. */
  async #make(type: string, isNew: boolean): Promise<void> {
    this.#made = type;
    this.#unknown = "";
    say(this.#type, type);
    let typedefs: TypeDef[];
    try {
      typedefs = await this.#model.typedefs(type);
    } catch (error) {
      // A topic may have a type that the hub does not know; its messages can be shown all the same.
      if (this.#made === type) this.#unknown = (error as Error).message;
      typedefs = [];
    }
    // Another type may have come meanwhile.
    if (this.#made !== type) return;
    const types = new Types(typedefs);
    this.#tools?.echo.hide();
    this.#tools?.publish?.close();
    const known = typedefs.length > 0;
    this.#tools = {
      echo: new Echo(this.#hub, this.#name, type, known ? types : undefined, (path) =>
        this.#plot.add(this.#name, path),
      ),
      publish: known ? new Publish(this.#hub, this.#name, type, types) : undefined,
    };
    replace(this.#echo.body, this.#tools.echo.element);
    replace(
      this.#publish.body,
      this.#tools.publish?.element ??
        h("p", { class: "soft" }, "A form needs the type's definition."),
    );
    replace(this.#definition.body, ...(known ? definitions(typedefs) : []));
    replace(this.#picker, this.#plotPicker(types));
    if (isNew) this.#publish.element.open = true;
    this.#showEcho();
    this.#update();
  }

  #showEcho(): void {
    if (this.#echo.element.open && this.#stops.length > 0) this.#tools?.echo.show();
    else this.#tools?.echo.hide();
  }

  #plotPicker(types: Types): HTMLElement | null {
    const paths = types.leafPaths();
    if (paths.length === 0) return null;
    const input = h("input", {
      class: "mono grow",
      list: "topic-paths",
      value: types.plotPaths()[0] ?? paths[0] ?? "",
      "aria-label": "Field to plot",
      autocomplete: "off",
      spellcheck: "false",
    });
    const add = (event: Event): void => {
      event.preventDefault();
      this.#plot.add(this.#name, input.value.trim());
    };
    return h(
      "form",
      { class: "toolbar topic-picker", onsubmit: add },
      input,
      h("datalist", { id: "topic-paths" }, ...paths.map((path) => h("option", { value: path }))),
      h("button", { type: "submit" }, "Plot"),
    );
  }

  #measure(): void {
    const topic = this.#topic;
    if (topic === undefined) {
      say(this.#flow, "");
      return;
    }
    const row = topicRow(topic, this.#model.rates.value);
    const drops =
      row.drops === 0 ? "" : ` · ${row.dropping ? "⚠ " : ""}${plural(row.drops, "drop")}`;
    say(
      this.#flow,
      `${hertz(row.rate)} · ${bandwidth(row.bandwidth)} · ${plural(row.publishers, "publisher")} · ${plural(row.subscribers, "subscriber")}${drops}`,
    );
  }

  #connect(topic: TopicInfo | undefined): void {
    const text = JSON.stringify([topic?.publishers, topic?.subscriptions]);
    if (text === this.#connected) return;
    this.#connected = text;
    const publishers = topic?.publishers ?? [];
    const subscriptions = topic?.subscriptions ?? [];
    replace(
      this.#connections.body,
      connections(
        "Publishers",
        publishers.map(({ node, latch }) => [
          node,
          this.#notes(node, latch ? "latched: newcomers get the last message" : ""),
        ]),
      ),
      connections(
        "Subscribers",
        subscriptions.map((each) => [each.node, this.#notes(each.node, terms(each))]),
      ),
    );
  }

  #notes(node: string, note: string): string {
    return [node === this.#hub.node ? "this page" : "", note]
      .filter((part) => part !== "")
      .join(", ");
  }
}

function terms({
  queue_length,
  throttle_rate,
  compression,
}: TopicInfo["subscriptions"][number]): string {
  return [
    throttle_rate > 0 ? `at most every ${throttle_rate} ms` : "",
    queue_length > 0 ? `queue ${queue_length}` : "",
    compression !== "" && compression !== "none" ? compression : "",
  ]
    .filter((term) => term !== "")
    .join(", ");
}

function connections(label: string, nodes: [node: string, note: string][]): HTMLElement {
  return h(
    "div",
    {},
    h("h3", {}, label),
    nodes.length === 0
      ? h("p", { class: "soft small" }, "none")
      : h(
          "ul",
          { class: "plain" },
          ...nodes.map(([node, note]) =>
            h(
              "li",
              {},
              h("a", { class: "mono", href: route("graph", "node", node) }, node),
              note === "" ? null : h("span", { class: "soft small" }, ` ${note}`),
            ),
          ),
        ),
  );
}

interface Section {
  readonly element: HTMLDetailsElement;
  readonly body: HTMLElement;
}

function section(label: string, open: boolean): Section {
  const body = h("div", { class: "browse-body" });
  return {
    element: h("details", { class: "section", open }, h("summary", {}, h("h3", {}, label)), body),
    body,
  };
}
