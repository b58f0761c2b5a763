/** The toolbar of the graph, and the options that it sets. */
import { h, svg } from "../dom";
import { Filter, FilterInput } from "../filter";
import type { GraphOptions } from "./options";
import type { Kind } from "./picture";

export const DEFAULTS: GraphOptions = {
  topics: true,
  services: false,
  actions: true,
  deadEnds: true,
  quiet: true,
  debug: false,
  namespaces: null,
  types: null,
  filter: new Filter(),
};

/** The switches and their names in a URL. */
const SWITCHES = {
  services: "services",
  actions: "actions",
  namespaces: "namespaces",
  types: "types",
  deadEnds: "dead-ends",
  quiet: "quiet",
  debug: "debug",
} as const;
type Switch = keyof typeof SWITCHES;

/** The options in the state of a URL, such as `?filter=/robot&services=1&actions=0`. */
export function optionsOf(state: URLSearchParams): GraphOptions {
  const options = { ...DEFAULTS, filter: new Filter(state.get("filter") ?? "") };
  options.topics = state.get("elements") !== "nodes";
  for (const [option, name] of Object.entries(SWITCHES) as [Switch, string][]) {
    const value = state.get(name);
    if (value === "0" || value === "1") options[option] = value === "1";
  }
  return options;
}

/** The state for a URL that has these options; default values are left out. */
export function stateOfOptions(options: GraphOptions): Record<string, string> {
  const state: Record<string, string> = { filter: options.filter.text };
  if (!options.topics) state.elements = "nodes";
  for (const [option, name] of Object.entries(SWITCHES) as [Switch, string][]) {
    const value = options[option];
    if (value !== null && value !== DEFAULTS[option]) state[name] = value ? "1" : "0";
  }
  return state;
}

export class Toolbar {
  readonly element: HTMLElement;
  readonly #switches = new Map<Switch, HTMLInputElement>();
  readonly #options: GraphOptions;
  readonly #changed: () => void;
  readonly #filter = new FilterInput("Filter graph", () =>
    this.#set({ filter: this.#filter.filter }),
  );
  readonly #elements: HTMLSelectElement;

  /** The toolbar changes `options`, and calls `changed` each time. */
  constructor(options: GraphOptions, changed: () => void) {
    this.#options = options;
    this.#changed = changed;
    this.#elements = h(
      "select",
      {
        "aria-label": "Elements",
        onchange: () => this.#set({ topics: this.#elements.value === "topics" }),
      },
      h("option", { value: "topics" }, "Nodes and topics"),
      h("option", { value: "nodes" }, "Nodes only"),
    );
    this.element = h(
      "div",
      { class: "toolbar", role: "group", "aria-label": "Graph options" },
      this.#elements,
      this.#filter.element,
      h(
        "fieldset",
        { class: "switches" },
        h("legend", { class: "visually-hidden" }, "Shown"),
        this.#switch(
          "services",
          "Services",
          "Services, with a dashed arrow to their node",
          "service",
        ),
        this.#switch("actions", "Actions", "Actions, in place of their five topics", "action"),
        this.#switch("namespaces", "Namespaces", "Boxes around the elements of a namespace"),
        this.#switch("types", "Types", "Types of topics, services and actions"),
        this.#switch("deadEnds", "Dead ends", "Topics without a publisher or without a subscriber"),
        this.#switch("quiet", "Quiet", "Nodes and topics without messages in the last half minute"),
        this.#switch(
          "debug",
          "Debug",
          "The hub's own nodes, /rosout, this page, and the topics of actions",
        ),
      ),
    );
  }

  /** Show the options after they were changed elsewhere. */
  update(): void {
    this.#elements.value = this.#options.topics ? "topics" : "nodes";
    this.#filter.text = this.#options.filter.text;
    for (const [name, box] of this.#switches) box.checked = this.#options[name] ?? false;
  }

  /** Check the boxes of options that are set automatically. */
  showAutomatic(drawn: { namespaces: boolean; types: boolean }): void {
    for (const name of ["namespaces", "types"] as const) {
      const box = this.#switches.get(name);
      if (box !== undefined && this.#options[name] === null) box.checked = drawn[name];
    }
  }

  #switch(name: Switch, label: string, title: string, kind?: Kind): HTMLElement {
    const box = h("input", {
      type: "checkbox",
      name,
      onchange: ({ target }: Event) => this.#set({ [name]: (target as HTMLInputElement).checked }),
    });
    this.#switches.set(name, box);
    return h("label", { title }, box, kind === undefined ? null : icon(kind), label);
  }

  #set(change: Partial<GraphOptions>): void {
    Object.assign(this.#options, change);
    this.#changed();
  }
}

/** A small icon of an element's shape. */
export function icon(kind: Kind): SVGElement {
  const shapes: Record<Kind, () => SVGElement[]> = {
    node: () => [svg("ellipse", { class: "outline", cx: 10, cy: 7, rx: 8.5, ry: 5.5 })],
    topic: () => [svg("rect", { class: "outline", x: 1.5, y: 2, width: 17, height: 10, rx: 2 })],
    service: () => [svg("polygon", { class: "outline", points: "1,7 5,2 15,2 19,7 15,12 5,12" })],
    action: () => [
      svg("rect", { class: "outline", x: 1.5, y: 1.5, width: 17, height: 11, rx: 5.5 }),
      svg("rect", { class: "inline", x: 4, y: 4, width: 12, height: 6, rx: 3 }),
    ],
  };
  return svg(
    "svg",
    { class: `icon ${kind}`, viewBox: "0 0 20 14", "aria-hidden": "true" },
    ...shapes[kind](),
  );
}
