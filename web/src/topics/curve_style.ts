/** The styles of curves, which differ in colour, dashes and markers, and their legend. */
import { cutName, h, setText, svg } from "../dom";
import { figure } from "../format";
import { numberText } from "../messages/values";
import type { Extent } from "./axes";

/** The number of colours, dashes and markers. */
const STYLES = 8;

const DASHES: readonly (readonly number[])[] = [
  [],
  [9, 4],
  [2, 3],
  [11, 4, 2, 4],
  [16, 5],
  [5, 3],
  [11, 4, 2, 4, 2, 4],
  [1, 5],
];

/** Markers within the square from -1 to 1. */
const MARKERS: readonly (readonly (readonly [number, number])[])[] = [
  circle(16),
  [
    [-0.9, -0.9],
    [0.9, -0.9],
    [0.9, 0.9],
    [-0.9, 0.9],
  ],
  [
    [0, -1.1],
    [1.1, 0.9],
    [-1.1, 0.9],
  ],
  [
    [0, -1.2],
    [1.2, 0],
    [0, 1.2],
    [-1.2, 0],
  ],
  [
    [0, 1.1],
    [1.1, -0.9],
    [-1.1, -0.9],
  ],
  circle(5),
  [
    [-0.4, -1.1],
    [0.4, -1.1],
    [0.4, -0.4],
    [1.1, -0.4],
    [1.1, 0.4],
    [0.4, 0.4],
    [0.4, 1.1],
    [-0.4, 1.1],
    [-0.4, 0.4],
    [-1.1, 0.4],
    [-1.1, -0.4],
    [-0.4, -0.4],
  ],
  circle(6),
];

function circle(corners: number): [number, number][] {
  return Array.from({ length: corners }, (_, at) => {
    const angle = (2 * Math.PI * at) / corners - Math.PI / 2;
    return [1.1 * Math.cos(angle), 1.1 * Math.sin(angle)];
  });
}

/** The number of the dashes and the marker of a style: those of further rounds of colours are others. */
function patternOf(style: number): number {
  return (style + Math.floor(style / STYLES)) % STYLES;
}

/** The dashes of a style, in CSS pixels; empty for a full line. */
export function dashesOf(style: number): readonly number[] {
  return DASHES[patternOf(style)] ?? [];
}

/** The corners of a style's marker. */
export function markerOf(style: number): readonly (readonly [number, number])[] {
  return MARKERS[patternOf(style)] ?? [];
}

/** A sample of a style for the legend, in the current text colour. */
export function swatch(style: number): SVGElement {
  const marker = markerOf(style)
    .map(([x, y]) => `${28 + 3.6 * x},${6 + 3.6 * y}`)
    .join(" ");
  return svg(
    "svg",
    { class: `swatch curve-${style % STYLES}`, viewBox: "0 0 34 12", "aria-hidden": "true" },
    svg("line", {
      x1: 1,
      y1: 6,
      x2: 24,
      y2: 6,
      stroke: "currentColor",
      "stroke-width": 2,
      "stroke-dasharray": dashesOf(style).join(" ") || null,
    }),
    svg("polygon", { points: marker, fill: "currentColor" }),
  );
}

/** An entry of the legend: a sample of the curve, its name and value, and a button to remove it. */
export class LegendEntry {
  readonly element: HTMLElement;
  /** The number of its dashes, marker and colour. */
  readonly style: number;
  readonly #swatch: SVGElement;
  readonly #path = h("span");
  readonly #value = h("output", { class: "plot-value" }, "–");
  readonly #range = h("span", {
    class: "plot-range small soft",
    title: "Minimum … maximum of what is seen",
  });

  /** `remove` is called when the user removes the curve. */
  constructor(topic: string, path: string, style: number, remove: () => void) {
    this.style = style;
    this.#swatch = swatch(style);
    this.element = h(
      "li",
      {},
      this.#swatch,
      h("span", { class: "plot-name" }, cutName(topic, "soft"), " ", this.#path),
      this.#value,
      this.#range,
      h(
        "button",
        {
          type: "button",
          class: "quiet plot-remove",
          title: "Remove",
          "aria-label": `Remove ${topic} ${path}`,
          onclick: remove,
        },
        "×",
      ),
    );
    this.showPath(path);
  }

  /** The colour for the canvas in the current colour scheme; needs to be in the document. */
  get colour(): string {
    return getComputedStyle(this.#swatch).color;
  }

  /** Show the path of its number, to which a message may add names; returns whether it changed. */
  showPath(path: string): boolean {
    if (this.#path.textContent === path) return false;
    setText(this.#path, path);
    this.#path.title = path;
    return true;
  }

  /** Show the minimum and the maximum of what is seen; `NOTHING` if there are no numbers. */
  showExtent([low, high]: Extent): void {
    setText(this.#range, low > high ? "" : `${figure(low)} … ${figure(high)}`);
  }

  /** Show a value, with all its digits in the tooltip; `undefined` is a gap. */
  showValue(value: number | bigint | undefined): void {
    const sent = value === undefined ? "" : numberText(value);
    const isRounded = typeof value === "number" && Number.isFinite(value) && !Object.is(value, -0);
    setText(this.#value, isRounded ? figure(value) : sent || "–");
    this.#value.title = sent;
  }
}
