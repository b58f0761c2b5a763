/** Draws curves on a canvas, by uPlot. */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import {
  axisText,
  clock,
  type Extent,
  linearExtent,
  logarithmicExtent,
  logarithmicTicks,
} from "./axes";
import { DASHES, drawMarker } from "./curve_style";
import { align, type Samples } from "./ring_buffer";

/** The look of a curve: the number of its dashes and marker, and its colour. */
export interface Look {
  readonly style: number;
  readonly colour: string;
}

export interface Colours {
  readonly ink: string;
  readonly line: string;
}

/** Possible times between two labels of the time axis, in seconds. */
const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300];

export class Chart {
  readonly element = document.createElement("div");
  #plot: uPlot | undefined;
  #extent: Extent = [0, 1];
  #from = 0;
  #to = 1;
  /** Whether each curve has so few samples that they are drawn as points. */
  #sparse: boolean[] = [];
  readonly #point: (time: number | undefined) => void;

  /** `point` receives the time under the mouse, and `undefined` when it leaves. */
  constructor(point: (time: number | undefined) => void) {
    this.#point = point;
    this.element.className = "plot-canvas";
  }

  /** Create the chart for some curves. */
  create(looks: readonly Look[], colours: Colours, logarithmic: boolean): void {
    this.#plot?.destroy();
    this.#plot = undefined;
    // uPlot computes ticks at once: on a logarithmic axis, those from zero would never end.
    this.#extent = logarithmic ? [1, 10] : [0, 1];
    if (looks.length === 0) return;
    const axis = {
      stroke: colours.ink,
      font: "11px system-ui, sans-serif",
      grid: { stroke: colours.line, width: 1 },
      ticks: { stroke: colours.line, width: 1, size: 4 },
      gap: 4,
    };
    this.#plot = new uPlot(
      {
        ...this.#size(),
        legend: { show: false },
        cursor: { drag: { x: false, y: false }, points: { show: false }, y: false },
        scales: {
          x: { time: true, range: () => [this.#from, this.#to] },
          y: { distr: logarithmic ? 3 : 1, range: () => [...this.#extent] },
        },
        axes: [
          { ...axis, size: 26, space: 64, incrs: SECONDS, values: (_, times) => times.map(clock) },
          {
            ...axis,
            space: 30,
            size: (_, labels) =>
              16 + 6.5 * Math.max(3, ...(labels ?? []).map((label) => label.length)),
            values: (_, values) => values.map((value) => (value === null ? "" : axisText(value))),
            ...(logarithmic
              ? {
                  splits: (plot: uPlot) => logarithmicTicks(this.#extent, plot.height / 24),
                  filter: (_: uPlot, ticks: number[]) => ticks,
                }
              : {}),
          },
        ],
        series: [{}, ...looks.map((look, at) => this.#series(look, at, looks.length))],
        hooks: {
          drawSeries: [(plot, at) => drawMarker(plot, at, looks[at - 1])],
          setCursor: [(plot) => this.#hover(plot)],
        },
      },
      [[], ...looks.map(() => [])],
      this.element,
    );
  }

  /** Show the samples between two times, in seconds. */
  show(curves: readonly Samples[], from: number, to: number, logarithmic: boolean): void {
    const plot = this.#plot;
    if (plot === undefined) return;
    this.#from = from;
    this.#to = to;
    const shown = logarithmic ? curves.map(positive) : curves;
    this.#extent = (logarithmic ? logarithmicExtent : linearExtent)(shown, from);
    this.#sparse = shown.map(({ times }) => times.length < plot.width / 14);
    const { width, height } = this.#size();
    if (width !== plot.width || height !== plot.height) plot.setSize({ width, height });
    plot.setData(align(shown) as uPlot.AlignedData);
  }

  #series({ style, colour }: Look, at: number, count: number): uPlot.Series {
    return {
      stroke: colour,
      width: 2,
      dash: [...(DASHES[style] ?? [])],
      ...(count === 1 ? { fill: colour.replace(/^rgb\(([^)]*)\)$/, "rgba($1, 0.12)") } : {}),
      points: { show: () => this.#sparse[at] === true, size: 5, width: 1, fill: colour },
    };
  }

  #hover({ cursor, data }: uPlot): void {
    const at = (cursor.left ?? -1) < 0 ? undefined : cursor.idx;
    this.#point(at === null || at === undefined ? undefined : data[0][at]);
  }

  #size(): { width: number; height: number } {
    return {
      width: Math.max(120, this.element.clientWidth),
      height: Math.max(100, this.element.clientHeight),
    };
  }
}

function positive({ times, values }: Samples): Samples {
  return { times, values: values.map((value) => (value > 0 ? value : NaN)) };
}
