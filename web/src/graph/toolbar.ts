/** The toolbar of the graph, and the options that it sets. */
import { h, svg } from "../dom";
import { Filter, filterInput } from "../filter";
import type { Kind } from "./picture";

/** What the graph shows. */
export interface GraphOptions {
  /** Topics as elements of their own, or as labels of the edges between nodes. */
  topics: boolean;
  services: boolean;
  actions: boolean;
  deadEnds: boolean;
  debug: boolean;
  /** null: only if there is more than one. */
  namespaces: boolean | null;
  /** The types of topics, services and actions; null: only in small graphs. */
  types: boolean | null;
  filter: Filter;
}

export const DEFAULTS: GraphOptions = {
  topics: true,
  services: false,
  actions: true,
  deadEnds: true,
  debug: false,
  namespaces: null,
  types: null,
  filter: new Filter(),
};

const KEY = "fibws.graph";

/** Load the options of the last visit; invalid ones get their defaults. */
export function loadOptions(
  storage: () => Pick<Storage, "getItem"> = () => localStorage,
): GraphOptions {
  const options = { ...DEFAULTS };
  try {
    const saved: unknown = JSON.parse(storage().getItem(KEY) ?? "null");
    if (saved === null || typeof saved !== "object") return options;
    const { topics, services, actions, deadEnds, debug, namespaces, types, filter } =
      saved as Record<string, unknown>;
    if (typeof topics === "boolean") options.topics = topics;
    if (typeof services === "boolean") options.services = services;
    if (typeof actions === "boolean") options.actions = actions;
    if (typeof deadEnds === "boolean") options.deadEnds = deadEnds;
    if (typeof debug === "boolean") options.debug = debug;
    if (typeof namespaces === "boolean") options.namespaces = namespaces;
    if (typeof types === "boolean") options.types = types;
    if (typeof filter === "string") options.filter = new Filter(filter);
  } catch {
    // Storage is forbidden, or has something else.
  }
  return options;
}

/** Save the options for the next visit. */
export function saveOptions(
  options: GraphOptions,
  storage: () => Pick<Storage, "setItem"> = () => localStorage,
): void {
  try {
    storage().setItem(KEY, JSON.stringify({ ...options, filter: options.filter.text }));
  } catch {
    // Storage is forbidden.
  }
}

type Switch = "services" | "actions" | "deadEnds" | "debug" | "namespaces" | "types";

export class Toolbar {
  readonly element: HTMLElement;
  readonly #switches = new Map<Switch, HTMLInputElement>();
  readonly #options: GraphOptions;
  readonly #changed: () => void;

  /** The toolbar changes `options`, and calls `changed` each time. */
  constructor(options: GraphOptions, changed: () => void) {
    this.#options = options;
    this.#changed = changed;
    this.element = h(
      "div",
      { class: "toolbar", role: "group", "aria-label": "Graph options" },
      h(
        "select",
        {
          "aria-label": "Elements",
          value: options.topics ? "topics" : "nodes",
          onchange: ({ target }: Event) =>
            this.#set({ topics: (target as HTMLSelectElement).value === "topics" }),
        },
        h("option", { value: "topics" }, "Nodes and topics"),
        h("option", { value: "nodes" }, "Nodes only"),
      ),
      filterInput("Filter graph", (filter) => this.#set({ filter }), options.filter.text),
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
        this.#switch(
          "debug",
          "Debug",
          "The hub's own nodes, /rosout, this page, and the topics of actions",
        ),
      ),
    );
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
      checked: this.#options[name] ?? false,
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
