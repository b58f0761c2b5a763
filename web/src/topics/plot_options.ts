/** The settings of a plot: what is horizontal, the axes, how samples are connected, and the range of time. */
import { h } from "../dom";
import type { Across } from "./chart";
import { ranges, type ViewState } from "./plot_state";
import type { Shape } from "./strip";

const ACROSS: readonly (readonly [Across, string])[] = [
  ["time", "Time"],
  ["index", "Index of arrays"],
  ["xy", "X-Y: the first curve"],
];

const SHAPES: readonly (readonly [Shape, string])[] = [
  ["lines", "Lines"],
  ["steps", "Steps"],
  ["points", "Points"],
];

export class PlotOptions {
  /** The settings beside the range of time, which are shown on demand. */
  readonly element: HTMLElement;
  readonly range: HTMLSelectElement;
  readonly #across: HTMLSelectElement;
  readonly #shape: HTMLSelectElement;
  readonly #log: HTMLInputElement;
  readonly #logAcross: HTMLInputElement;
  readonly #separate: HTMLInputElement;
  readonly #logAcrossLabel: HTMLElement;
  readonly #separateLabel: HTMLElement;

  constructor(changed: () => void) {
    const select = <T extends string>(label: string, all: readonly (readonly [T, string])[]) =>
      h(
        "select",
        { "aria-label": label, onchange: changed },
        ...all.map(([value, text]) => h("option", { value }, text)),
      );
    const checkbox = (label: string) =>
      h("input", { type: "checkbox", "aria-label": label, onchange: changed });
    this.range = select(
      "Time range",
      ranges.all.map(({ seconds, label }) => [String(seconds), label]),
    );
    this.range.value = ranges.usual;
    this.#across = select("Horizontal axis", ACROSS);
    this.#shape = select("Samples as", SHAPES);
    this.#log = checkbox("Logarithmic");
    this.#logAcross = checkbox("Logarithmic across");
    this.#separate = checkbox("Own axes");
    const label = (input: HTMLElement, text: string, title: string) =>
      h("label", { title }, input, text);
    this.#logAcrossLabel = label(this.#logAcross, "Log across", "Logarithmic horizontal axis");
    this.#separateLabel = label(this.#separate, "Own axes", "Each curve has an axis of its own");
    this.element = h(
      "div",
      { class: "toolbar plot-settings", role: "group", "aria-label": "Settings", hidden: true },
      h("label", {}, "Across", this.#across),
      h("label", {}, "As", this.#shape),
      label(this.#log, "Log", "Logarithmic vertical axis"),
      this.#logAcrossLabel,
      this.#separateLabel,
    );
  }

  get across(): Across {
    return this.#across.value as Across;
  }

  set across(across: Across) {
    this.#across.value = across;
  }

  get shape(): Shape {
    return this.#shape.value as Shape;
  }

  get seconds(): number {
    return Number(this.range.value);
  }

  get logarithmic(): boolean {
    return this.#log.checked;
  }

  get logarithmicAcross(): boolean {
    return this.#logAcross.checked;
  }

  get separate(): boolean {
    return this.#separate.checked;
  }

  /** Show what can be chosen for so many curves. */
  update(curves: number): void {
    this.#separateLabel.hidden = curves < 2;
    this.#logAcrossLabel.hidden = this.across === "time";
  }

  /** The settings that belong into the URL. */
  get state(): ViewState {
    return {
      range: this.range.value === ranges.usual ? "" : this.range.value,
      across: this.across === "time" ? "" : this.across,
      shape: this.shape === "lines" ? "" : this.shape,
      log: this.logarithmic,
      log_across: this.logarithmicAcross,
      own_axes: this.separate,
    };
  }

  restore(state: URLSearchParams): void {
    restoreChoice(this.range, state.get("range"), ranges.usual);
    restoreChoice(this.#across, state.get("across"), "time");
    restoreChoice(this.#shape, state.get("shape"), "lines");
    this.#log.checked = state.has("log");
    this.#logAcross.checked = state.has("log_across");
    this.#separate.checked = state.has("own_axes");
  }
}

/** Choose a value if there is such an option. */
function restoreChoice(select: HTMLSelectElement, value: string | null, usual: string): void {
  const options = [...select.options].map((option) => option.value);
  select.value = value !== null && options.includes(value) ? value : usual;
}
