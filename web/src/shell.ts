/** The page around the views: tabs, state of the connection, counts. */
import "./shell.css";

import { PLAYBACK, RECORDER } from "./bags/names";
import type { Log } from "./console/log";
import { h, replace, setText, svg } from "./dom";
import type { Files } from "./dropped_files";
import { hertz } from "./format";
import { applicationLink, FOXGLOVE } from "./foxglove";
import { isHidden } from "./hidden_names";
import type { Hub, State } from "./hub";
import type { Login } from "./login";
import type { Graph, Model, Rates } from "./model";
import { openButton } from "./open_button";
import { route } from "./view";

export const TABS = [
  { name: "graph", label: "Graph" },
  { name: "dashboard", label: "Dashboard" },
  { name: "topics", label: "Topics" },
  { name: "services", label: "Services" },
  { name: "actions", label: "Actions" },
  { name: "console", label: "Console" },
  { name: "parameters", label: "Parameters" },
  { name: "reconfigure", label: "Reconfigure" },
  { name: "turtlesim", label: "Turtlesim" },
  { name: "hubs", label: "Hubs" },
] as const;
export type Tab = (typeof TABS)[number]["name"];

/** The tabs that are hidden until there is something in them. */
const RARE: Partial<Record<Tab, (graph: Graph) => boolean>> = {
  reconfigure: ({ services }) =>
    services.some(({ type }) => type === "dynamic_reconfigure/Reconfigure"),
  turtlesim: ({ services }) => services.some(({ type }) => type === "turtlesim/Spawn"),
  hubs: ({ nodes }) => nodes.some(({ hub }) => hub),
};

const STATES: Record<State, string> = {
  connecting: "connecting …",
  open: "connected",
  closed: "disconnected: reconnecting …",
};
/** The highest number that a badge shows. */
const MAX_BADGE = 99;

export class Shell {
  /** The place of the chosen view. */
  readonly stage = h("main", { id: "stage", tabindex: -1 });
  readonly #links = new Map<Tab, HTMLAnchorElement>();
  readonly #nodes = h("dd", { id: "count-nodes" }, "–");
  readonly #topics = h("dd", { id: "count-topics" }, "–");
  readonly #rate = h("dd", { id: "count-rate" }, "–");
  /** The place of what is shown once there is a recorder or a player. */
  readonly #bags = h("div", { id: "bags" });

  constructor(hub: Hub, model: Model, login: Login, open: (files: Files) => void) {
    replace(document.body, this.#header(hub, model.log, login, open), this.stage);
    this.#badge(model);
    this.#showBags(hub, model);
    model.graph.watch((graph) => this.#showCounts(graph));
    model.rates.watch((rates) => this.#showRate(rates));
  }

  /** Mark a tab as chosen. */
  select(tab: Tab): void {
    this.#reveal(tab);
    for (const [name, link] of this.#links) {
      if (name === tab) {
        link.setAttribute("aria-current", "page");
        // The tabs may be wider than a narrow window.
        link.scrollIntoView({ block: "nearest", inline: "nearest" });
      } else {
        link.removeAttribute("aria-current");
      }
    }
    const label = TABS.find(({ name }) => name === tab)?.label ?? "";
    document.title = `${label} · fibws hub`;
  }

  #header(hub: Hub, log: Log, login: Login, open: (files: Files) => void): HTMLElement {
    const count = (noun: string, number: HTMLElement) => h("div", {}, h("dt", {}, noun), number);
    return h(
      "header",
      { id: "header" },
      h(
        "a",
        { class: "skip", href: "#stage", onclick: (event: Event) => this.#skip(event) },
        "Skip to content",
      ),
      h("h1", {}, logo(), "fibws"),
      connectionState(hub, log),
      h(
        "dl",
        { id: "counts" },
        count("nodes", this.#nodes),
        count("topics", this.#topics),
        count("messages", this.#rate),
      ),
      h("nav", { "aria-label": "Views" }, ...TABS.map(({ name, label }) => this.#tab(name, label))),
      h(
        "div",
        { id: "tools" },
        this.#bags,
        accountPlace(hub, login),
        openButton(open),
        applicationLink(FOXGLOVE, hub.url, "Foxglove"),
        h(
          "button",
          { type: "button", class: "quiet", id: "help", onclick: () => void showHelp(hub.url) },
          "Help",
        ),
      ),
    );
  }

  #tab(name: Tab, label: string): HTMLElement {
    const link = h("a", { href: route(name), id: `tab-${name}` }, label);
    this.#links.set(name, link);
    link.hidden = name in RARE;
    return link;
  }

  /** Show a tab that most hubs have no use for; it stays. */
  #reveal(name: Tab): void {
    const link = this.#links.get(name);
    if (link !== undefined) link.hidden = false;
  }

  #badge({ log }: Model): void {
    const number = h("span", { class: "badge warn", hidden: true });
    this.#links.get("console")?.append(number);
    log.unseen.watch((count) => {
      number.hidden = count === 0;
      replace(
        number,
        count > MAX_BADGE ? `${MAX_BADGE}+` : count,
        h(
          "span",
          { class: "visually-hidden" },
          count === 1 ? " warning or error" : " warnings and errors",
        ),
      );
    });
  }

  /** Load the controls of bags once the hub can record, or a bag is played. */
  #showBags(hub: Hub, model: Model): void {
    let isLoaded = false;
    model.graph.watch((graph) => {
      if (isLoaded || graph === null || !hasBags(graph)) return;
      isLoaded = true;
      void import("./bags/controls").then(({ bagControls }) => {
        replace(this.#bags, ...bagControls(hub, model));
      });
    });
  }

  #showCounts(graph: Graph | null): void {
    if (graph === null) return;
    for (const { name } of TABS) if (RARE[name]?.(graph)) this.#reveal(name);
    showCount(this.#nodes, graph.nodes, "node");
    showCount(this.#topics, graph.topics, "topic");
  }

  #showRate(rates: Rates): void {
    let messages = 0;
    for (const [topic, flow] of rates.topics) if (!isHidden(topic)) messages += flow.messages;
    setText(this.#rate, rates.topics.size === 0 ? "–" : hertz(messages));
  }

  /** The fragment is the route, so a link to #stage would leave the view. */
  #skip(event: Event): void {
    event.preventDefault();
    this.stage.focus();
  }
}

async function showHelp(url: string): Promise<void> {
  (await import("./welcome")).showHelp(url);
}

/** Whether there is something to record or play with. */
function hasBags({ services, topics }: Graph): boolean {
  return (
    services.some(({ name }) => name === `${RECORDER}/start`) ||
    topics.some(({ type }) => type === PLAYBACK)
  );
}

/** Show how many are not hidden, with the noun in singular or plural before it. */
function showCount(
  number: HTMLElement,
  all: readonly { readonly name: string }[],
  one: string,
): void {
  const count = all.filter(({ name }) => !isHidden(name)).length;
  setText(number, String(count));
  const term = number.previousElementSibling;
  if (term !== null) setText(term, count === 1 ? one : `${one}s`);
}

/** The hub's address, and the state of the connection: as a mark and in words. */
function connectionState(hub: Hub, log: Log): HTMLElement {
  const text = h("span", { id: "state", role: "status" });
  const button = h(
    "button",
    { class: "quiet", hidden: true, onclick: () => hub.connect() },
    "Connect",
  );
  const box = h(
    "div",
    { id: "hub" },
    h("code", { title: `This page is the node ${hub.node}` }, hub.url.replace(/\/$/, "")),
    text,
    button,
  );
  const update = () => {
    box.dataset.state = hub.state.value;
    const why = hub.reason.value === "" ? "" : ` (${hub.reason.value})`;
    setText(text, (hub.ended.value ? "closed" : STATES[hub.state.value]) + why);
    // Without another token the hub would refuse the page again.
    button.hidden = !hub.ended.value || hub.denied.value !== "";
  };
  log.isSettled.watch((isSettled) => {
    box.dataset.messages = isSettled ? "open" : "closed";
  });
  hub.denied.watch(update);
  hub.state.watch(update);
  hub.reason.watch(update);
  hub.ended.watch(update);
  return box;
}

/** The logo: the hub, and three nodes around it. */
function logo(): SVGElement {
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

/** Who the page is, once the hub has said it. */
function accountPlace(hub: Hub, login: Login): HTMLElement {
  const place = h("div", {});
  let isNamed = false;
  login.who.watch((who) => {
    if (isNamed || !who?.name) return;
    isNamed = true;
    void import("./login_form").then(({ account }) => place.replaceWith(account(hub, login)));
  });
  return place;
}
