/** The filter of every view: its syntax, and the input for it. */
import { h } from "./dom";

const HELP = `All words must match, in any case:
scan: anywhere in a name, type or text
/robot: at the start of a name
-camera, -/tf: excludes what matches`;

/** A filter's text, parsed once for many comparisons. */
export class Filter {
  readonly text: string;
  readonly #wanted: readonly Matcher[];
  readonly #unwanted: readonly Matcher[];

  constructor(text = "") {
    this.text = text.trim();
    const words = this.text
      .toLowerCase()
      .split(/[\s,]+/)
      .filter(Boolean);
    const isNegative = (word: string): boolean => word.startsWith("-");
    this.#wanted = words.filter((word) => !isNegative(word)).map(matcher);
    this.#unwanted = words
      .filter(isNegative)
      .map((word) => word.slice(1))
      .filter(Boolean)
      .map(matcher);
  }

  get isEmpty(): boolean {
    return this.text === "";
  }

  /** Whether every word occurs in one of the fields, and no excluded word does. */
  matches(...fields: string[]): boolean {
    const text = joined(fields);
    return this.#wanted.every((isIn) => isIn(text)) && !this.#unwanted.some((isIn) => isIn(text));
  }

  /**
   * Whether something is shown: if it or one of its neighbours matches, and it is not excluded.
   *
   * A topic's neighbours are its publishers and subscribers, in a list as in the graph.
   */
  shows(fields: readonly string[], neighbours: readonly (readonly string[])[] = []): boolean {
    if (this.matches(...fields)) return true;
    return !this.excludes(...fields) && neighbours.some((each) => this.matches(...each));
  }

  /** Whether an excluded word occurs in one of the fields. */
  excludes(...fields: string[]): boolean {
    const text = joined(fields);
    return this.#unwanted.some((isIn) => isIn(text));
  }
}

type Matcher = (text: string) => boolean;

function matcher(word: string): Matcher {
  if (!word.startsWith("/")) return (text) => text.includes(word);
  // Names also occur within texts: "subscribed to /scan".
  const nameStart = new RegExp(`(?<![\\w/])${word.replace(/[^\w/]/g, "\\$&")}`);
  return (text) => nameStart.test(text);
}

function joined(fields: readonly string[]): string {
  return fields.join("\n").toLowerCase();
}

/** The fields of a node, topic, service or action; a service's node is one of its fields. */
export function fieldsOf(named: { name: string; type?: string; node?: string }): string[] {
  return [named.name, named.type ?? "", named.node ?? ""];
}

/** The input for a view's filter. */
export class FilterInput {
  readonly element: HTMLInputElement;
  #filter = new Filter();

  /** `changed` is called when the user changes the filter. */
  constructor(label: string, changed: () => void) {
    this.element = h("input", {
      type: "search",
      class: "grow",
      placeholder: "Filter: scan /robot -camera",
      title: HELP,
      "aria-label": label,
      spellcheck: "false",
      autocapitalize: "none",
      autocomplete: "off",
      oninput: () => {
        this.#filter = new Filter(this.element.value);
        changed();
      },
    });
  }

  get filter(): Filter {
    return this.#filter;
  }

  /** Set the filter's text, as a link to the view has it. */
  set text(text: string) {
    this.#filter = new Filter(text);
    if (this.#filter.text !== this.element.value.trim()) this.element.value = text;
  }
}
