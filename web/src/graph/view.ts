// The graph, live: nodes, topics, services and actions, and what flows between them.

import "./view.css";

import { h, replace, say } from "../dom";
import type { Graph, Model, Rates } from "../model";
import { type MakeView, route, type View } from "../view";
import { asText } from "./as_text";
import { recall, remember } from "./choices";
import { Details } from "./details";
import { Drawing } from "./drawing";
import { Layout } from "./layout";
import type { Kind, Picture } from "./picture";
import { idOf, picture } from "./picture";
import { around, type Box, type Places } from "./places";
import { anchored, planOf } from "./plan";
import { ruler } from "./shapes";
import { icon, Toolbar } from "./toolbar";
import { Viewport } from "./viewport";

const KINDS: readonly Kind[] = ["node", "topic", "service", "action"];
const NOTHING: Picture = { elements: [], edges: [], groups: [], typed: true };
/** Below this width in pixels the layers lie from the top down. */
const NARROW = 560;
/** A layout that takes longer, in ms, is excused in words. */
const LONG = 700;

export const makeView: MakeView = (_hub, model) => new GraphView(model);

class GraphView implements View {
  readonly element: HTMLElement;
  readonly #model: Model;
  readonly #choices = recall();
  readonly #measure = ruler();
  readonly #notice = h("p", { class: "hint", role: "status" });
  readonly #empty = h("p", { class: "empty", hidden: true });
  readonly #legend = h("p", { class: "legend", "aria-hidden": "true" });
  readonly #text = h("pre", { tabindex: 0 });
  readonly #unfolded = h(
    "details",
    { class: "as-text", ontoggle: () => this.#tellText() },
    h("summary", {}, "As text"),
    this.#text,
  );
  readonly #drawing = new Drawing({
    choose: ({ id, kind, name }) => {
      location.hash = id === this.#chosen ? route("graph") : route("graph", kind, name);
    },
    visit: (box) => this.#viewport.reveal(box, this.#details.covers()),
  });
  readonly #stage = h(
    "div",
    {
      class: "stage",
      role: "group",
      tabindex: 0,
      "aria-label": "Graph: arrow keys move it, plus and minus zoom, 0 shows all",
    },
    this.#drawing.element,
    this.#empty,
    this.#legend,
    this.#notice,
  );
  readonly #viewport = new Viewport(this.#stage, this.#drawing.root, (zoom) =>
    this.#drawing.zoom(zoom),
  );
  readonly #details: Details;
  readonly #toolbar = new Toolbar(this.#choices, () => {
    remember(this.#choices);
    this.#follow(this.#model.graph.value);
  });
  readonly #layout = new Layout(
    (places) => this.#place(places),
    (why) => {
      window.clearTimeout(this.#hint);
      say(this.#notice, `The graph could not be laid out: ${why}`);
    },
  );
  readonly #resized = new ResizeObserver(() => this.#follow(this.#model.graph.value));
  readonly #escape = ({ key, target }: KeyboardEvent): void => {
    const taken = target instanceof HTMLInputElement || document.querySelector("dialog[open]");
    if (key === "Escape" && this.#chosen !== null && !taken) this.#close();
  };
  #shown: Picture = NOTHING;
  #asked: { picture: Picture; down: boolean } = { picture: NOTHING, down: false };
  #plan = "";
  #places: Places | null = null;
  #hint: number | undefined;
  #stops: (() => void)[] = [];
  #chosen: string | null = null;

  constructor(model: Model) {
    this.#model = model;
    this.#details = new Details(model, () => this.#close());
    this.element = h(
      "section",
      { class: "graph", "aria-label": "Graph" },
      this.#toolbar.element,
      h("div", { class: "beside" }, this.#stage, this.#details.element, this.#zoom()),
      this.#unfolded,
    );
  }

  /** `["node", "/talker"]` shows the details of that. */
  show(path: string[]): void {
    if (this.#stops.length === 0) {
      this.#resized.observe(this.#stage);
      document.addEventListener("keydown", this.#escape);
      this.#stops = [
        this.#model.graph.watch((graph) => this.#follow(graph)),
        this.#model.rates.watch((rates) => this.#tellRates(rates)),
        this.#model.clients.watch(() => this.#details.measure()),
        () => this.#resized.disconnect(),
        () => document.removeEventListener("keydown", this.#escape),
      ];
    }
    this.#choose(path);
  }

  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
  }

  #zoom(): HTMLElement {
    const button = (label: string, title: string, act: () => void, face: string): HTMLElement =>
      h("button", { class: "icon", "aria-label": label, title, onclick: act }, face);
    return h(
      "div",
      { class: "zoom", role: "group", "aria-label": "Zoom" },
      button("Zoom out", "Zoom out (−)", () => this.#viewport.zoom(0.8), "−"),
      button("Zoom in", "Zoom in (+)", () => this.#viewport.zoom(1.25), "+"),
      button("Fit", "Show everything (0)", () => this.#viewport.fit(), "Fit"),
    );
  }

  #follow(graph: Graph | null): void {
    this.#details.follow(graph);
    if (graph === null) {
      this.#empty.hidden = false;
      say(this.#empty, "Asking the hub for its graph …");
      return;
    }
    const next = picture(graph, this.#choices);
    this.#toolbar.tell({ namespaces: next.groups.length > 0, types: next.typed });
    this.#tellLegend(next);
    this.#empty.hidden = next.elements.length > 0;
    say(
      this.#empty,
      this.#choices.filter === ""
        ? "No nodes yet. Each one appears here as it comes."
        : `Nothing has ${this.#choices.filter} in its name. Clear the filter to see everything.`,
    );
    this.#arrange(next);
  }

  /** Have a picture laid out, or draw it at once where its places are known. */
  #arrange(next: Picture): void {
    const { width, aspect: exact } = this.#viewport;
    const down = width > 0 && width < NARROW;
    const aspect = Math.round(exact * 4) / 4;
    const plan = planOf(next, this.#measure, { aspect, down });
    // The size of the window alone moves nothing, unless the layers turn.
    const key = JSON.stringify({ ...plan, aspect: 0 });
    this.#asked = { picture: next, down };
    if (key === this.#plan) {
      if (!this.#layout.busy && this.#places !== null) this.#draw(this.#places);
      return;
    }
    this.#plan = key;
    this.#layout.ask(plan);
    window.clearTimeout(this.#hint);
    this.#hint = window.setTimeout(() => {
      if (this.#layout.busy) say(this.#notice, `Laying out ${next.elements.length} elements …`);
    }, LONG);
  }

  /** The answer to what was asked. */
  #place(answer: Places): void {
    window.clearTimeout(this.#hint);
    say(this.#notice, "");
    // Who has moved the drawing looks at something: that stays where it is.
    const former = this.#viewport.fits ? null : this.#places;
    const places = former === null ? answer : anchored(answer, former);
    this.#places = places;
    this.#draw(places);
    this.#viewport.contain(places.bounds);
    this.#tellText();
  }

  #draw(places: Places): void {
    this.#shown = this.#asked.picture;
    this.#drawing.draw(this.#shown, places, this.#asked.down, this.#model.rates.value);
  }

  #tellRates(rates: Rates): void {
    this.#drawing.measure(rates);
    this.#details.measure();
    this.#tellText();
  }

  #tellText(): void {
    if (!this.#unfolded.open) return;
    say(this.#text, asText(this.#shown, this.#model.rates.value) || "Nothing is in sight.");
  }

  #tellLegend({ elements }: Picture): void {
    const kinds = KINDS.filter((kind) => elements.some((element) => element.kind === kind));
    if (this.#legend.dataset.kinds === kinds.join()) return;
    this.#legend.dataset.kinds = kinds.join();
    replace(this.#legend, ...kinds.map((kind) => h("span", {}, icon(kind), kind)));
  }

  #choose([word = "", name = ""]: readonly string[]): void {
    const kind = KINDS.find((each) => each === word);
    const wanted = kind === undefined || name === "" ? null : { kind, name };
    this.#chosen = wanted && idOf(wanted.kind, wanted.name);
    this.#details.show(wanted);
    this.#drawing.choose(this.#chosen);
    const box = this.#chosen === null ? undefined : this.#places?.boxes.get(this.#chosen);
    if (box === undefined) {
      if (this.#viewport.fits) this.#viewport.fit();
      return;
    }
    // With its neighbours, if there is room for them.
    const near = around(this.#neighbourhood(this.#chosen)) ?? box;
    this.#viewport.reveal(near, this.#details.covers());
    this.#viewport.reveal(box, this.#details.covers());
  }

  #neighbourhood(id: string | null): Box[] {
    return this.#shown.edges
      .filter(({ from, to }) => from === id || to === id)
      .flatMap(({ from, to }) => [this.#places?.boxes.get(from), this.#places?.boxes.get(to)])
      .filter((box) => box !== undefined);
  }

  #close(): void {
    const back = this.#chosen;
    location.hash = route("graph");
    if (back !== null) this.#drawing.focus(back);
  }
}
