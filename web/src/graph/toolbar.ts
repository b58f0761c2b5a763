// What its reader can choose of the graph.

import { h, svg } from "../dom";
import type { Choices } from "./choices";
import type { Kind } from "./picture";

type Switch = "services" | "actions" | "deadEnds" | "debug" | "namespaces" | "types";

export class Toolbar {
  readonly element: HTMLElement;
  readonly #switches = new Map<Switch, HTMLInputElement>();
  readonly #choices: Choices;
  readonly #changed: () => void;

  /** `choices` is changed here, and `changed` called then. */
  constructor(choices: Choices, changed: () => void) {
    this.#choices = choices;
    this.#changed = changed;
    this.element = h(
      "div",
      { class: "toolbar", role: "group", "aria-label": "What the graph shows" },
      h(
        "select",
        {
          "aria-label": "What is drawn",
          value: choices.topics ? "topics" : "nodes",
          onchange: ({ target }: Event) =>
            this.#choose({ topics: (target as HTMLSelectElement).value === "topics" }),
        },
        h("option", { value: "topics" }, "Nodes and topics"),
        h("option", { value: "nodes" }, "Nodes only"),
      ),
      h("input", {
        class: "grow",
        type: "search",
        value: choices.filter,
        placeholder: "Filter: /robot or scan",
        "aria-label": "Filter by namespace or by a part of the name",
        title: "/robot: what begins so; scan: what has it anywhere; and their neighbours",
        spellcheck: "false",
        autocomplete: "off",
        oninput: ({ target }: Event) =>
          this.#choose({ filter: (target as HTMLInputElement).value }),
      }),
      h(
        "fieldset",
        { class: "switches" },
        h("legend", { class: "visually-hidden" }, "Shown"),
        this.#switch(
          "services",
          "Services",
          "Services, with a dashed arrow to their provider",
          "service",
        ),
        this.#switch("actions", "Actions", "Actions; their five topics are one box", "action"),
        this.#switch("namespaces", "Namespaces", "Boxes around those of one namespace"),
        this.#switch("types", "Types", "The types of topics, services and actions"),
        this.#switch("deadEnds", "Dead ends", "Topics without a publisher or without a subscriber"),
        this.#switch(
          "debug",
          "Debug",
          "The hub's own nodes, /rosout, this page, and the topics of actions",
        ),
      ),
    );
  }

  /** What is drawn of that which nobody has chosen. */
  tell(drawn: { namespaces: boolean; types: boolean }): void {
    for (const name of ["namespaces", "types"] as const) {
      const box = this.#switches.get(name);
      if (box !== undefined && this.#choices[name] === null) box.checked = drawn[name];
    }
  }

  #switch(name: Switch, label: string, title: string, kind?: Kind): HTMLElement {
    const box = h("input", {
      type: "checkbox",
      name,
      checked: this.#choices[name] ?? false,
      onchange: ({ target }: Event) =>
        this.#choose({ [name]: (target as HTMLInputElement).checked }),
    });
    this.#switches.set(name, box);
    return h("label", { title }, box, kind === undefined ? null : icon(kind), label);
  }

  #choose(part: Partial<Choices>): void {
    Object.assign(this.#choices, part);
    this.#changed();
  }
}

/** A small picture of an element's shape. */
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
