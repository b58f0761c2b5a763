/** What stands around the views: the tabs, the hub's state, and how much is going on. */
import "./shell.css";

import { h, replace, say, svg } from "./dom";
import { hertz } from "./format";
import { isHidden } from "./hidden";
import type { Hub, State } from "./hub";
import type { Graph, Model, Rates } from "./model";
import { route } from "./view";
import { help } from "./welcome";

export const TABS = [
  { name: "graph", label: "Graph" },
  { name: "topics", label: "Topics" },
  { name: "services", label: "Services" },
  { name: "console", label: "Console" },
  { name: "parameters", label: "Parameters" },
] as const;
export type Tab = (typeof TABS)[number]["name"];

const STATES: Record<State, string> = {
  connecting: "connecting …",
  open: "connected",
  closed: "lost: trying again …",
};
/** A count that no tab can show all of. */
const MANY = 99;

export class Shell {
  /** Where the view of the chosen tab is shown. */
  readonly stage = h("main", { id: "stage", tabindex: -1 });
  readonly #links = new Map<Tab, HTMLAnchorElement>();
  readonly #nodes = h("dd", { id: "count-nodes" }, "–");
  readonly #topics = h("dd", { id: "count-topics" }, "–");
  readonly #rate = h("dd", { id: "count-rate" }, "–");

  constructor(hub: Hub, model: Model) {
    replace(document.body, this.#header(hub), this.stage);
    this.#badge(model);
    model.graph.watch((graph) => this.#count(graph));
    model.rates.watch((rates) => this.#measure(rates));
  }

  /** Mark a tab as the one in sight. */
  select(tab: Tab): void {
    for (const [name, link] of this.#links) {
      if (name === tab) {
        link.setAttribute("aria-current", "page");
        // In a narrow window the tabs are wider than it is.
        link.scrollIntoView({ block: "nearest", inline: "nearest" });
      } else {
        link.removeAttribute("aria-current");
      }
    }
    const label = TABS.find(({ name }) => name === tab)?.label ?? "";
    document.title = `${label} · fibws hub`;
  }

  #header(hub: Hub): HTMLElement {
    const count = (what: string, number: HTMLElement) => h("div", {}, h("dt", {}, what), number);
    return h(
      "header",
      { id: "header" },
      h(
        "a",
        { class: "skip", href: "#stage", onclick: (event: Event) => this.#skip(event) },
        "To the content",
      ),
      h("h1", {}, mark(), "fibws"),
      state(hub),
      h(
        "dl",
        { id: "counts" },
        count("nodes", this.#nodes),
        count("topics", this.#topics),
        count("messages", this.#rate),
      ),
      h("nav", { "aria-label": "Views" }, ...TABS.map(({ name, label }) => this.#tab(name, label))),
      h(
        "button",
        { type: "button", class: "quiet", id: "help", onclick: () => help(hub.url) },
        "Help",
      ),
    );
  }

  #tab(name: Tab, label: string): HTMLElement {
    const link = h("a", { href: route(name), id: `tab-${name}` }, label);
    this.#links.set(name, link);
    return link;
  }

  #badge({ log }: Model): void {
    const number = h("span", { class: "badge warn", hidden: true });
    this.#links.get("console")?.append(number);
    log.unseen.watch((count) => {
      number.hidden = count === 0;
      replace(
        number,
        count > MANY ? `${MANY}+` : count,
        h(
          "span",
          { class: "visually-hidden" },
          count === 1 ? " warning or error" : " warnings and errors",
        ),
      );
    });
  }

  #count(graph: Graph | null): void {
    if (graph === null) return;
    tell(this.#nodes, graph.nodes, "node");
    tell(this.#topics, graph.topics, "topic");
  }

  #measure(rates: Rates): void {
    let messages = 0;
    for (const [topic, flow] of rates.topics) if (!isHidden(topic)) messages += flow.messages;
    say(this.#rate, rates.topics.size === 0 ? "–" : hertz(messages));
  }

  /** The address belongs to the routes, so the jump is made here. */
  #skip(event: Event): void {
    event.preventDefault();
    this.stage.focus();
  }
}

/** Say how many there are, and what they are: the term stands before its number. */
function tell(number: HTMLElement, all: readonly { readonly name: string }[], one: string): void {
  const count = all.filter(({ name }) => !isHidden(name)).length;
  say(number, String(count));
  const term = number.previousElementSibling;
  if (term !== null) say(term, count === 1 ? one : `${one}s`);
}

/** The hub's address, and whether it is there: told by a mark, in words, and aloud. */
function state(hub: Hub): HTMLElement {
  const words = h("span", { id: "state", role: "status" });
  const again = h(
    "button",
    { class: "quiet", hidden: true, onclick: () => hub.connect() },
    "Connect",
  );
  const box = h(
    "div",
    { id: "hub" },
    h("code", { title: `This page is ${hub.node} there` }, hub.url.replace(/\/$/, "")),
    words,
    again,
  );
  const tell = () => {
    box.dataset.state = hub.state.value;
    const why = hub.reason.value === "" ? "" : ` (${hub.reason.value})`;
    say(words, (hub.ended.value ? "closed" : STATES[hub.state.value]) + why);
    again.hidden = !hub.ended.value;
  };
  hub.state.watch(tell);
  hub.reason.watch(tell);
  hub.ended.watch(tell);
  return box;
}

/** The hub, and three nodes around it. */
function mark(): SVGElement {
  const ends = [
    [6, 6],
    [26, 6],
    [16, 27],
  ] as const;
  return svg(
    "svg",
    { viewBox: "0 0 32 32", "aria-hidden": "true", fill: "currentColor", stroke: "currentColor" },
    ...ends.map(([x2, y2]) => svg("line", { x1: 16, y1: 16, x2, y2, "stroke-width": 3 })),
    svg("circle", { cx: 16, cy: 16, r: 6, stroke: "none" }),
    ...ends.map(([cx, cy]) => svg("circle", { cx, cy, r: 4, stroke: "none" })),
  );
}
