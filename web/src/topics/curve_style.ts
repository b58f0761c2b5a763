/** The styles of curves, which differ in dashes and markers as well as colour, and their legend. */
import type uPlot from "uplot";
import { h, setText, svg } from "../dom";
import { figure } from "../format";

/** The number of colours, dashes and markers. */
export const STYLES = 8;

export const DASHES: readonly (readonly number[])[] = [
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

/** A sample of a style for the legend, in the current text colour. */
export function swatch(style: number): SVGElement {
  const marker = (MARKERS[style] ?? []).map(([x, y]) => `${28 + 3.6 * x},${6 + 3.6 * y}`).join(" ");
  return svg(
    "svg",
    { class: `swatch curve-${style}`, viewBox: "0 0 34 12", "aria-hidden": "true" },
    svg("line", {
      x1: 1,
      y1: 6,
      x2: 24,
      y2: 6,
      stroke: "currentColor",
      "stroke-width": 2,
      "stroke-dasharray": (DASHES[style] ?? []).join(" ") || null,
    }),
    svg("polygon", { points: marker, fill: "currentColor" }),
  );
}

/** Draw the marker of a curve at its last visible sample. */
export function drawMarker(
  plot: uPlot,
  at: number,
  look: { style: number; colour: string } | undefined,
): void {
  const [times, values] = [plot.data[0], plot.data[at] ?? []];
  if (look === undefined) return;
  const to = plot.scales.x?.max ?? Infinity;
  for (let row = times.length - 1; row >= 0; row -= 1) {
    const [time, value] = [times[row], values[row]];
    if (typeof value !== "number" || time === undefined || time > to) continue;
    const [x, y, size] = [
      plot.valToPos(time, "x", true),
      plot.valToPos(value, "y", true),
      4.5 * devicePixelRatio,
    ];
    plot.ctx.save();
    plot.ctx.fillStyle = look.colour;
    plot.ctx.setLineDash([]);
    plot.ctx.beginPath();
    for (const [dx, dy] of MARKERS[look.style] ?? []) plot.ctx.lineTo(x + size * dx, y + size * dy);
    plot.ctx.closePath();
    plot.ctx.fill();
    plot.ctx.restore();
    return;
  }
}

/** An entry of the legend: a sample of the curve, its name and value, and a button to remove it. */
export class LegendEntry {
  readonly element: HTMLElement;
  /** The number of its dashes, marker and colour. */
  readonly style: number;
  readonly #swatch: SVGElement;
  readonly #value = h("output", { class: "plot-value" }, "–");

  /** `remove` is called when the user removes the curve. */
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
          title: "Remove",
          "aria-label": `Remove ${topic} ${path}`,
          onclick: remove,
        },
        "×",
      ),
    );
  }

  /** The colour for the canvas in the current colour scheme; needs to be in the document. */
  get colour(): string {
    return getComputedStyle(this.#swatch).color;
  }

  showValue(value: number | undefined): void {
    setText(this.#value, value === undefined || Number.isNaN(value) ? "–" : figure(value));
  }
}
