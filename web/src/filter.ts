/** The filter of every view: its syntax, and the input for it. */
import { h } from "./dom";

const HELP = `All words must match, in any case:
scan: anywhere in a name, type or text
/robot: at the start of a name
-camera: excludes what matches`;

/** A filter's text, parsed once for many comparisons. */
export class Filter {
  readonly text: string;
  readonly #wanted: readonly Matcher[];
  readonly #unwanted: readonly Matcher[];

  constructor(text = "") {
    this.text = text.trim();
    const words = this.text.toLowerCase().split(/\s+/).filter(Boolean);
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

/** A search input; `changed` receives the filter on each change. */
export function filterInput(
  label: string,
  changed: (filter: Filter) => void,
  value = "",
): HTMLInputElement {
  const input: HTMLInputElement = h("input", {
    type: "search",
    class: "grow",
    placeholder: "Filter: scan /robot -camera",
    title: HELP,
    value,
    "aria-label": label,
    spellcheck: "false",
    autocomplete: "off",
    oninput: () => changed(new Filter(input.value)),
  });
  return input;
}
