// The graph, live: nodes, topics, services and actions, and what flows between them.

import "./view.css";

import { h, replace, say } from "../dom";
import type { Graph } from "../model";
import type { MakeView, View } from "../view";
import { route } from "../view";
import { type Box, type Places, around } from "./places";
import { asText } from "./as_text";
import { recall, remember } from "./choices";
import { Details } from "./details";
import { Drawing } from "./drawing";
import { Layout } from "./layout";
import type { Kind, Picture } from "./picture";
import { idOf, picture } from "./picture";
import { anchored, planOf } from "./plan";
import { ruler } from "./shapes";
import { Toolbar, icon } from "./toolbar";
import { Viewport } from "./viewport";

const KINDS: readonly Kind[] = ["node", "topic", "service", "action"];
const NOTHING: Picture = { elements: [], edges: [], groups: [], typed: true };
/** Below this width in pixels the layers lie from the top down. */
const NARROW = 560;
/** A layout that takes longer, in ms, is excused in words. */
const LONG = 700;

export const makeView: MakeView = (_hub, model): View => {
  const choices = recall();
  const measure = ruler();
  let shown: Picture = NOTHING;
  let asked: { picture: Picture; down: boolean } = { picture: NOTHING, down: false };
  let plan = "";
  let places: Places | null = null;
  let hint: number | undefined;
  let stops: (() => void)[] = [];
  let chosen: string | null = null;

  const drawing = new Drawing({
    choose: ({ id, kind, name }) => {
      location.hash = id === chosen ? route("graph") : route("graph", kind, name);
    },
    visit: (box) => viewport.reveal(box, details.covers()),
  });
  const notice = h("p", { class: "hint", role: "status" });
  const empty = h("p", { class: "empty", hidden: true });
  const legend = h("p", { class: "legend", "aria-hidden": "true" });
  const stage = h(
    "div",
    {
      class: "stage",
      role: "group",
      tabindex: 0,
      "aria-label": "Graph: arrow keys move it, plus and minus zoom, 0 shows all",
    },
    drawing.element,
    empty,
    legend,
    notice,
  );
  const viewport = new Viewport(stage, drawing.root, (zoom) => drawing.zoom(zoom));
  const button = (label: string, title: string, act: () => void, face: string): HTMLElement =>
    h("button", { class: "icon", "aria-label": label, title, onclick: act }, face);
  const zoom = h(
    "div",
    { class: "zoom", role: "group", "aria-label": "Zoom" },
    button("Zoom out", "Zoom out (−)", () => viewport.zoom(0.8), "−"),
    button("Zoom in", "Zoom in (+)", () => viewport.zoom(1.25), "+"),
    button("Fit", "Show everything (0)", () => viewport.fit(), "Fit"),
  );
  const details = new Details(model, close);
  const text = h("pre", { tabindex: 0 });
  const unfolded = h(
    "details",
    { class: "as-text", ontoggle: () => tellText() },
    h("summary", {}, "As text"),
    text,
  );
  const toolbar = new Toolbar(choices, () => {
    remember(choices);
    follow(model.graph.value);
  });
  const layout = new Layout(
    (answer) => {
      window.clearTimeout(hint);
      say(notice, "");
      // Who has moved the drawing looks at something: that stays where it is.
      places = places === null || viewport.fits ? answer : anchored(answer, places);
      shown = asked.picture;
      drawing.draw(shown, places, asked.down, model.rates.value);
      viewport.contain(places.bounds);
      tellText();
    },
    (why) => {
      window.clearTimeout(hint);
      say(notice, `The graph could not be laid out: ${why}`);
    },
  );

  function follow(graph: Graph | null): void {
    details.follow(graph);
    if (graph === null) {
      empty.hidden = false;
      say(empty, "Asking the hub for its graph …");
      return;
    }
    const next = picture(graph, choices);
    toolbar.tell({ namespaces: next.groups.length > 0, types: next.typed });
    tellLegend(next);
    empty.hidden = next.elements.length > 0;
    say(
      empty,
      choices.filter === ""
        ? "No nodes yet. Each one appears here as it comes."
        : `Nothing has ${choices.filter} in its name. Clear the filter to see everything.`,
    );
    const down = viewport.width > 0 && viewport.width < NARROW;
    const aspect = Math.round(viewport.aspect * 4) / 4;
    const nextPlan = planOf(next, measure, { aspect, down });
    // The size of the window alone moves nothing, unless the layers turn.
    const key = JSON.stringify({ ...nextPlan, aspect: 0 });
    asked = { picture: next, down };
    if (key === plan) {
      if (!layout.busy && places !== null) {
        shown = next;
        drawing.draw(shown, places, down, model.rates.value);
      }
      return;
    }
    plan = key;
    layout.ask(nextPlan);
    window.clearTimeout(hint);
    hint = window.setTimeout(() => {
      if (layout.busy) say(notice, `Laying out ${next.elements.length} elements …`);
    }, LONG);
  }

  function tellText(): void {
    if (unfolded.open) say(text, asText(shown, model.rates.value) || "Nothing is in sight.");
  }

  function tellLegend({ elements }: Picture): void {
    const kinds = KINDS.filter((kind) => elements.some((element) => element.kind === kind));
    if (legend.dataset["kinds"] === kinds.join()) return;
    legend.dataset["kinds"] = kinds.join();
    replace(legend, ...kinds.map((kind) => h("span", {}, icon(kind), kind)));
  }

  function neighbourhood(id: string | null): Box[] {
    return shown.edges
      .filter(({ from, to }) => from === id || to === id)
      .flatMap(({ from, to }) => [places?.boxes.get(from), places?.boxes.get(to)])
      .filter((box) => box !== undefined);
  }

  function close(): void {
    const back = chosen;
    location.hash = route("graph");
    if (back !== null) drawing.focus(back);
  }

  function escape({ key, target }: KeyboardEvent): void {
    const taken = target instanceof HTMLInputElement || document.querySelector("dialog[open]");
    if (key === "Escape" && chosen !== null && !taken) close();
  }

  function choose(path: readonly string[]): void {
    const [word = "", name = ""] = path;
    const kind = KINDS.find((each) => each === word);
    const wanted = kind === undefined || name === "" ? null : { kind, name };
    chosen = wanted && idOf(wanted.kind, wanted.name);
    details.show(wanted);
    drawing.choose(chosen);
    const box = chosen === null ? undefined : places?.boxes.get(chosen);
    if (box === undefined) {
      if (viewport.fits) viewport.fit();
      return;
    }
    // With its neighbours, if there is room for them.
    viewport.reveal(around(neighbourhood(chosen)) ?? box, details.covers());
    viewport.reveal(box, details.covers());
  }

  const resized = new ResizeObserver(() => follow(model.graph.value));
  const element = h(
    "section",
    { class: "graph", "aria-label": "Graph" },
    toolbar.element,
    h("div", { class: "beside" }, stage, details.element, zoom),
    unfolded,
  );

  return {
    element,
    show(path) {
      if (stops.length === 0) {
        resized.observe(stage);
        document.addEventListener("keydown", escape);
        stops = [
          model.graph.watch(follow),
          model.rates.watch((rates) => {
            drawing.measure(rates);
            details.measure();
            tellText();
          }),
          model.clients.watch(() => details.measure()),
          () => resized.disconnect(),
          () => document.removeEventListener("keydown", escape),
        ];
      }
      choose(path);
    },
    hide() {
      for (const stop of stops) stop();
      stops = [];
    },
  };
};
