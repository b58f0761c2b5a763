/** A curve in the legend: how it looks, its name, its value, and a way to be rid of it. */
import { h, say } from "../dom";
import { figure } from "../format";
import { swatch } from "./strokes";

export class LegendEntry {
  readonly element: HTMLElement;
  /** Which dashes, marker and colour it has. */
  readonly style: number;
  readonly #swatch: SVGElement;
  readonly #value = h("output", { class: "plot-value" }, "–");

  /** `remove` is called when its reader has had enough. */
  constructor(topic: string, path: string, style: number, remove: () => void) {
    this.style = style;
    this.#swatch = swatch(style);
    this.element = h(
      "li",
      {},
      this.#swatch,
      h("span", { class: "plot-name" }, h("span", { class: "soft" }, topic), ` ${path}`),
      this.#value,
      h(
        "button",
        {
          type: "button",
          class: "quiet plot-remove",
          title: "Take away",
          "aria-label": `Take ${topic} ${path} away`,
          onclick: remove,
        },
        "×",
      ),
    );
  }

  /** Its colour in this light, as a canvas takes it; it must be in the document. */
  get colour(): string {
    return getComputedStyle(this.#swatch).color;
  }

  tell(value: number | undefined): void {
    say(this.#value, value === undefined || Number.isNaN(value) ? "–" : figure(value));
  }
}
