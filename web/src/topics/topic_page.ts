/** The page of one topic: its picture or stick, its newest message, a form to publish, its connections and its type. */
import { browsePage } from "../browse";
import { breakable, h, replace, setName, setText } from "../dom";
import { expand } from "../element_names";
import { bandwidth, hertz, plural } from "../format";
import type { Model, TopicInfo } from "../model";
import { kindsFor } from "../panels/kinds";
import { closePanel, type Panel } from "../panels/panel";
import type { DataSource } from "../source";
import { definitions } from "../type_definition";
import { type TypeDef, Types } from "../types";
import { route } from "../view";
import { Echo } from "./echo";
import type { Plot } from "./plot";
import { PublishForm } from "./publish_form";
import { topicRow } from "./topic_list";

/** How many paths the field of the plot offers. */
const MAX_PATHS = 500;

export class TopicPage {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #plot: Plot;
  readonly #name: string;
  readonly #expectedType: string;
  readonly #type = h("code", { class: "soft" });
  readonly #flow = h("p", { class: "soft small topic-flow" });
  readonly #notice = h("p", { class: "notice", role: "status", hidden: true });
  readonly #picker = h("div");
  /** A section for each panel. */
  readonly #panelSections = h("div");
  readonly #echo = section("Raw messages", true);
  readonly #publish = section("Publish", false);
  readonly #connections = section("Connections", true);
  readonly #definition = section("Type", false);
  /** The type that the tools are for. */
  #toolsType = "";
  /** Why the definition of that type is missing, if it is. */
  #typeError = "";
  #tools: { echo: Echo; publish: PublishForm | undefined } | undefined;
  /** The panels for that type, as far as they are loaded. */
  #panels: { readonly panel: Panel; readonly section: HTMLDetailsElement }[] = [];
  #shownConnections = "";
  #stops: (() => void)[] = [];
  #isClosed = false;

  /** `expectedType` is the type that the topic will get if it does not exist yet. */
  constructor(hub: DataSource, model: Model, plot: Plot, name: string, expectedType: string) {
    this.#hub = hub;
    this.#model = model;
    this.#plot = plot;
    this.#name = name;
    this.#expectedType = expectedType;
    this.element = browsePage(
      name,
      "topics",
      this.#type,
      this.#flow,
      this.#notice,
      this.#picker,
      this.#panelSections,
      this.#echo.element,
      hub.canPublish ? this.#publish.element : null,
      this.#connections.element,
      this.#definition.element,
    );
    this.#echo.element.addEventListener("toggle", () => this.#toggleEcho());
  }

  /** The page becomes visible. */
  show(): void {
    if (this.#stops.length > 0) return;
    this.#stops = [
      this.#model.graph.watch(() => this.#update()),
      this.#model.rates.watch(() => this.#showRates()),
    ];
    this.#togglePanels();
    this.#toggleEcho();
  }

  /** The page becomes hidden: it subscribes and publishes no more. */
  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
    for (const { panel } of this.#panels) panel.hide();
    this.#tools?.echo.hide();
    this.#tools?.publish?.close();
  }

  /** The page is not shown again. */
  close(): void {
    this.#isClosed = true;
    this.hide();
    for (const { panel } of this.#panels) closePanel(panel);
    this.#panels = [];
  }

  get #topic(): TopicInfo | undefined {
    return this.#model.graph.value?.topics.find(({ name }) => name === this.#name);
  }

  #update(): void {
    const topic = this.#topic;
    const type = topic?.type || this.#expectedType;
    this.#showConnections(topic);
    this.#showRates();
    const notice = this.#noticeOf(topic, type);
    setText(this.#notice, notice);
    this.#notice.hidden = notice === "";
    if (type !== "" && type !== this.#toolsType) void this.#createTools(type, topic === undefined);
  }

  #noticeOf(topic: TopicInfo | undefined, type: string): string {
    if (this.#typeError !== "") return this.#typeError;
    if (type === "") {
      return this.#model.graph.value === null
        ? "Waiting for the hub …"
        : "This topic does not exist now. It appears here when a node publishes it.";
    }
    // The hub has the topic as soon as this page subscribes to it, which is no use by itself.
    const isUsed =
      topic !== undefined &&
      (topic.publishers.length > 0 ||
        topic.subscriptions.some(({ node }) => !this.#hub.isOwn(node)));
    return isUsed ? "" : "Nobody uses this topic yet. Publish its first message below.";
  }

  #createPanels(type: string): void {
    for (const { panel } of this.#panels) closePanel(panel);
    this.#panels = [];
    const kinds = kindsFor(type).filter(({ publishes }) => !publishes || this.#hub.canPublish);
    // The first one is the most special: a scene has joints, too, but does not show their numbers.
    if (kinds[0]?.replacesEcho) this.#echo.element.open = false;
    const sections = kinds.map((kind) => {
      const { element, body } = section(kind.label, true);
      element.addEventListener("toggle", () => this.#togglePanels());
      void kind.load().then(({ makePanel }) => {
        if (this.#toolsType !== type || this.#isClosed) return;
        const panel = makePanel(this.#hub, this.#model, this.#name, type);
        this.#panels.push({ panel, section: element });
        replace(body, panel.element);
        this.#togglePanels();
      });
      return element;
    });
    replace(this.#panelSections, ...sections);
  }

  async #createTools(type: string, isNew: boolean): Promise<void> {
    this.#toolsType = type;
    this.#typeError = "";
    setName(this.#type, type);
    this.#createPanels(type);
    let typedefs: TypeDef[];
    try {
      typedefs = await this.#model.typedefs(type);
    } catch (error) {
      // Messages of a type that the hub does not know can be shown nevertheless.
      if (this.#toolsType === type) this.#typeError = (error as Error).message;
      typedefs = [];
    }
    // The type may have changed meanwhile.
    if (this.#toolsType !== type) return;
    const types = new Types(typedefs);
    this.#tools?.echo.hide();
    this.#tools?.publish?.close();
    const isKnown = typedefs.length > 0;
    this.#tools = {
      echo: new Echo(this.#hub, this.#name, type, isKnown ? types : undefined, (path) =>
        this.#plot.add(this.#name, path),
      ),
      publish:
        isKnown && this.#hub.canPublish
          ? new PublishForm(this.#hub, this.#name, type, types)
          : undefined,
    };
    replace(this.#echo.body, this.#tools.echo.element);
    replace(
      this.#publish.body,
      this.#tools.publish?.element ??
        h("p", { class: "soft" }, "The form needs the definition of the type."),
    );
    replace(this.#definition.body, ...(isKnown ? definitions(typedefs) : []));
    replace(this.#picker, this.#plotPicker(types));
    if (isNew) this.#publish.element.open = true;
    this.#toggleEcho();
    this.#update();
  }

  #togglePanels(): void {
    for (const { panel, section } of this.#panels) {
      if (section.open && this.#stops.length > 0) panel.show();
      else panel.hide();
    }
  }

  #toggleEcho(): void {
    if (this.#echo.element.open && this.#stops.length > 0) this.#tools?.echo.show();
    else this.#tools?.echo.hide();
  }

  #plotPicker(types: Types): HTMLElement | null {
    const paths = types.numberPaths();
    if (paths.length === 0) return null;
    const options = h("datalist", { id: "topic-paths" });
    const offer = (): void => {
      const message = this.#tools?.echo.newest;
      const all = paths.flatMap((path) => (message === undefined ? path : expand(message, path)));
      replace(options, ...all.slice(0, MAX_PATHS).map((path) => h("option", { value: path })));
    };
    const input = h("input", {
      class: "mono grow",
      onfocus: offer,
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
      options,
      h("button", { type: "submit" }, "Plot"),
    );
  }

  #showRates(): void {
    const topic = this.#topic;
    if (topic === undefined) {
      setText(this.#flow, "");
      return;
    }
    const row = topicRow(topic, this.#model.rates.value);
    const drops =
      row.drops === 0 ? "" : ` · ${row.dropping ? "⚠ " : ""}${plural(row.drops, "drop")}`;
    setText(
      this.#flow,
      `${hertz(row.rate)} · ${bandwidth(row.bandwidth)} · ${plural(row.publishers, "publisher")} · ${plural(row.subscribers, "subscriber")}${drops}`,
    );
  }

  #showConnections(topic: TopicInfo | undefined): void {
    const text = JSON.stringify([topic?.publishers, topic?.subscriptions]);
    if (text === this.#shownConnections) return;
    this.#shownConnections = text;
    const publishers = topic?.publishers ?? [];
    const subscriptions = topic?.subscriptions ?? [];
    replace(
      this.#connections.body,
      connectionList(
        "Publishers",
        publishers.map(({ node, latch }) => [
          node,
          this.#notes(node, latch ? "latched: new subscribers get the last message" : ""),
        ]),
      ),
      connectionList(
        "Subscribers",
        subscriptions.map((each) => [each.node, this.#notes(each.node, subscriptionText(each))]),
      ),
    );
  }

  #notes(node: string, note: string): string {
    return [this.#hub.isOwn(node) ? "this page" : "", note]
      .filter((part) => part !== "")
      .join(", ");
  }
}

function subscriptionText({
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

function connectionList(label: string, nodes: [node: string, note: string][]): HTMLElement {
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
              h(
                "a",
                { class: "mono", title: node, href: route("graph", "node", node) },
                ...breakable(node),
              ),
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
  const summary = h("summary", {}, h("h3", {}, label));
  return { element: h("details", { class: "section", open }, summary, body), body };
}
