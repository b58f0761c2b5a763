/** The Graph tab: nodes, topics, services and actions, with live rates. */

import "./view.css";

import { h, replace, setText } from "../dom";
import { download } from "../download";
import type { Graph, Model, Rates } from "../model";
import type { MakeView, Place, View } from "../view";
import { asText } from "./as_text";
import { Details } from "./details";
import { Drawing } from "./drawing";
import { dotFile, svgFile } from "./export";
import { anchored, LayoutClient, layoutRequest } from "./layout_client";
import { around, type Box, type Layout, type Point, prefersDown } from "./layout_types";
import type { Kind, Picture } from "./picture";
import { idOf, picture } from "./picture";
import { textMeasure } from "./shapes";
import { DEFAULTS, icon, optionsOf, stateOfOptions, Toolbar } from "./toolbar";
import { Traffic } from "./traffic";
import { Viewport } from "./viewport";

const KINDS: readonly Kind[] = ["node", "topic", "service", "action"];
const NOTHING: Picture = { elements: [], edges: [], groups: [], typed: true };
/** After this time in ms, the user is told that the layout is being computed. */
const LONG = 700;

export const makeView: MakeView = (_hub, model, place) => new GraphView(model, place);

class GraphView implements View {
  readonly element: HTMLElement;
  readonly #model: Model;
  readonly #place: Place;
  readonly #options = { ...DEFAULTS };
  readonly #traffic = new Traffic();
  readonly #measure = textMeasure();
  readonly #notice = h("p", { class: "hint", role: "status" });
  readonly #empty = h("p", { class: "empty", hidden: true });
  readonly #legend = h("p", { class: "legend", "aria-hidden": "true" });
  readonly #text = h("pre", { tabindex: 0 });
  readonly #textDetails = h(
    "details",
    { class: "as-text", ontoggle: () => this.#showText() },
    h("summary", {}, "As text"),
    this.#text,
  );
  readonly #drawing = new Drawing({
    choose: ({ id, kind, name }) => {
      if (id === this.#chosen) this.#place.go("graph");
      else this.#place.go("graph", kind, name);
    },
    focus: (box) => this.#viewport.reveal(box, this.#details.covered()),
  });
  readonly #stage = h(
    "div",
    {
      class: "stage",
      role: "group",
      tabindex: 0,
      "aria-label": "Graph: arrow keys move, plus and minus zoom, 0 fits everything",
    },
    this.#drawing.element,
    this.#empty,
    this.#legend,
    this.#notice,
  );
  readonly #viewport = new Viewport(this.#stage, this.#drawing.root, (zoom) =>
    this.#drawing.setZoom(zoom),
  );
  readonly #details: Details;
  readonly #toolbar = new Toolbar(this.#options, () => {
    this.#place.save(stateOfOptions(this.#options));
    this.#update(this.#model.graph.value);
  });
  readonly #layouts = new LayoutClient(
    (layout) => this.#arrange(layout),
    (why) => {
      window.clearTimeout(this.#hint);
      setText(this.#notice, `The graph could not be laid out: ${why}`);
    },
  );
  readonly #resized = new ResizeObserver(() => this.#update(this.#model.graph.value));
  readonly #escape = ({ key, target }: KeyboardEvent): void => {
    const isOther = target instanceof HTMLInputElement || document.querySelector("dialog[open]");
    if (key === "Escape" && this.#chosen !== null && !isOther) this.#close();
  };
  #shown: Picture = NOTHING;
  #requested = NOTHING;
  #request = "";
  #layout: Layout | null = null;
  #hint: number | undefined;
  #stops: (() => void)[] = [];
  #chosen: string | null = null;

  constructor(model: Model, place: Place) {
    this.#model = model;
    this.#place = place;
    this.#details = new Details(model, () => this.#close());
    this.element = h(
      "section",
      { class: "graph", "aria-label": "Graph" },
      this.#toolbar.element,
      h("div", { class: "beside" }, this.#stage, this.#details.element, this.#zoom()),
      h("div", { class: "foot" }, this.#textDetails, this.#saveButtons()),
    );
  }

  /** `["node", "/talker"]` shows the details of that. */
  show(path: string[], state: URLSearchParams | null): void {
    if (state !== null) Object.assign(this.#options, optionsOf(state));
    this.#place.save(stateOfOptions(this.#options));
    this.#toolbar.update();
    if (this.#stops.length === 0) {
      this.#resized.observe(this.#stage);
      document.addEventListener("keydown", this.#escape);
      this.#stops = [
        this.#model.graph.watch((graph) => this.#update(graph)),
        this.#model.rates.watch((rates) => this.#showRates(rates)),
        this.#model.clients.watch(() => this.#details.updateNumbers()),
        () => this.#resized.disconnect(),
        () => document.removeEventListener("keydown", this.#escape),
      ];
    }
    this.#update(this.#model.graph.value);
    this.#choose(path);
  }

  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
  }

  close(): void {
    this.#layouts.close();
  }

  #saveButtons(): HTMLElement {
    const button = (format: string, title: string, save: () => void): HTMLElement =>
      h("button", { type: "button", title, "aria-label": title, onclick: save }, format);
    return h(
      "div",
      { class: "save", role: "group", "aria-label": "Save" },
      h("span", { class: "soft", "aria-hidden": "true" }, "Save:"),
      button("SVG", "Save the drawing as SVG", () => {
        if (this.#layout !== null)
          save("graph.svg", "image/svg+xml", svgFile(this.#drawing.root, this.#layout.bounds));
      }),
      button("DOT", "Save the graph as DOT, for Graphviz", () => {
        save("graph.dot", "text/vnd.graphviz", dotFile(this.#shown));
      }),
    );
  }

  #zoom(): HTMLElement {
    const button = (label: string, title: string, action: () => void, text: string): HTMLElement =>
      h("button", { class: "icon", "aria-label": label, title, onclick: action }, text);
    return h(
      "div",
      { class: "zoom", role: "group", "aria-label": "Zoom" },
      button("Zoom out", "Zoom out (−)", () => this.#viewport.zoom(0.8), "−"),
      button("Zoom in", "Zoom in (+)", () => this.#viewport.zoom(1.25), "+"),
      button("Fit", "Show everything (0)", () => this.#viewport.fit(), "Fit"),
    );
  }

  #update(graph: Graph | null): void {
    this.#details.update(graph);
    if (graph === null) {
      this.#empty.hidden = false;
      setText(this.#empty, "Waiting for the hub …");
      return;
    }
    const next = picture(graph, this.#options, (flow) => this.#traffic.isBusy(flow));
    this.#toolbar.showAutomatic({ namespaces: next.groups.length > 0, types: next.typed });
    this.#showLegend(next);
    this.#empty.hidden = next.elements.length > 0;
    setText(
      this.#empty,
      this.#options.filter.isEmpty && !this.#options.quiet
        ? "No messages in the last half minute. Check “Quiet” to see all nodes."
        : this.#options.filter.isEmpty
          ? "No nodes yet. Nodes appear here when they connect."
          : "No elements match the filter. Clear the filter to see everything.",
    );
    this.#layOut(next);
  }

  /** Request the layout of a picture, or draw it at once if only its data changed. */
  #layOut(next: Picture): void {
    const { canvas } = this.#viewport;
    const request = layoutRequest(next, this.#measure, canvas);
    // A new size of the window alone moves nothing, unless it is of another shape.
    const key = JSON.stringify({ ...request, canvas: prefersDown(canvas) });
    this.#requested = next;
    if (key === this.#request) {
      if (!this.#layouts.busy && this.#layout !== null) this.#draw(this.#layout);
      return;
    }
    this.#request = key;
    this.#layouts.request(request);
    window.clearTimeout(this.#hint);
    this.#hint = window.setTimeout(() => {
      if (this.#layouts.busy)
        setText(this.#notice, `Laying out ${next.elements.length} elements …`);
    }, LONG);
  }

  /** Draw a new layout. */
  #arrange(next: Layout): void {
    window.clearTimeout(this.#hint);
    setText(this.#notice, "");
    // If the user has moved the drawing, it stays in place.
    const previous = this.#viewport.isMoved ? this.#layout : null;
    const layout = previous === null ? next : anchored(next, previous);
    this.#layout = layout;
    this.#draw(layout);
    this.#viewport.contain(layout.bounds, startOf(layout));
    if (previous === null) this.#reveal();
    this.#showText();
  }

  #draw(layout: Layout): void {
    this.#shown = this.#requested;
    this.#drawing.draw(this.#shown, layout, this.#model.rates.value);
  }

  #showRates(rates: Rates): void {
    if (this.#traffic.record(rates, performance.now()) && !this.#options.quiet) {
      this.#update(this.#model.graph.value);
    }
    this.#drawing.updateRates(rates);
    this.#details.updateNumbers();
    this.#showText();
  }

  #showText(): void {
    if (!this.#textDetails.open) return;
    setText(this.#text, asText(this.#shown, this.#model.rates.value) || "The graph is empty.");
  }

  #showLegend({ elements }: Picture): void {
    const kinds = KINDS.filter((kind) => elements.some((element) => element.kind === kind));
    if (this.#legend.dataset.kinds === kinds.join()) return;
    this.#legend.dataset.kinds = kinds.join();
    replace(this.#legend, ...kinds.map((kind) => h("span", {}, icon(kind), kind)));
  }

  #choose([first = "", name = ""]: readonly string[]): void {
    const kind = KINDS.find((each) => each === first);
    const element = kind === undefined || name === "" ? null : { kind, name };
    this.#chosen = element && idOf(element.kind, element.name);
    this.#details.show(element);
    this.#drawing.choose(this.#chosen);
    if (this.#chosen === null) this.#viewport.refit();
    else this.#reveal();
  }

  /** Make the chosen element visible. */
  #reveal(): void {
    const box = this.#chosen === null ? undefined : this.#layout?.boxes.get(this.#chosen);
    if (box === undefined) return;
    // With its neighbours, if there is space.
    const area = around(this.#neighbourhood(this.#chosen)) ?? box;
    this.#viewport.reveal(area, this.#details.covered());
    this.#viewport.reveal(box, this.#details.covered());
  }

  #neighbourhood(id: string | null): Box[] {
    return this.#shown.edges
      .filter(({ from, to }) => from === id || to === id)
      .flatMap(({ from, to }) => [this.#layout?.boxes.get(from), this.#layout?.boxes.get(to)])
      .filter((box) => box !== undefined);
  }

  #close(): void {
    const chosen = this.#chosen;
    this.#place.go("graph");
    if (chosen !== null) this.#drawing.focus(chosen);
  }
}

/** The centre of the first box in the direction of the edges. */
function startOf({ boxes, down }: Layout): Point {
  const [first] = [...boxes.values()].sort(
    down ? (a, b) => a.y - b.y || a.x - b.x : (a, b) => a.x - b.x || a.y - b.y,
  );
  return first ?? { x: 0, y: 0 };
}

function save(name: string, type: string, text: string): void {
  download(name, new Blob([text], { type }));
}
