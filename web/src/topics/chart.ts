/**
 * Draws curves and their axes.
 *
 * The axes are on a canvas of their own, below that of the curves: the labels of the time axis are
 * relative to now, so that only the curves move.
 */

import { h } from "../dom";
import { greatest, least } from "../lists";
import {
  type Axis,
  agoText,
  axisText,
  clock,
  contains,
  type Extent,
  extentOf,
  linearAxis,
  logarithmicAxis,
  timeStep,
  union,
} from "./axes";
import type { RingBuffer } from "./ring_buffer";
import { type Look, MARGIN, Strip, type Stroke } from "./strip";

/** A curve: its samples and its look. */
export interface ChartCurve extends Look {
  readonly samples: RingBuffer;
}

export interface ChartStyle {
  /** The colours of text and of grid lines. */
  readonly ink: string;
  readonly line: string;
  readonly logarithmic: boolean;
  /** Whether each curve has an axis of its own. */
  readonly separate: boolean;
}

const FONT = "11px system-ui, sans-serif";
/** The height of the time axis, and the space around labels. In CSS pixels. */
const TIME_AXIS = 20;
const GAP = 6;
/** The minimum distances between labels, in CSS pixels. */
const LABEL_WIDTH = 72;
const LABEL_HEIGHT = 34;
/** The share of the width that axes may have; those of further curves are left out. */
const MAX_AXES = 0.4;
/** A curve looks flat if another one is as many times as high. */
const FLAT = 20;
/** Time after which axes are adapted to samples that are no longer visible, in seconds. */
const ADAPT = 0.5;

export class Chart {
  readonly element: HTMLElement;
  readonly #frame = document.createElement("canvas");
  readonly #strip = new Strip();
  readonly #cursor = h("div", { class: "plot-cursor", hidden: true });
  #curves: readonly ChartCurve[] = [];
  #style: ChartStyle = { ink: "", line: "", logarithmic: false, separate: false };
  #width = 0;
  #height = 0;
  /** The width of the axes on the left. */
  #left = 0;
  #axes: Axis[] = [];
  #lastAdapted = 0;
  /** What the chart was drawn for; everything is drawn again when it changes. */
  #drawnFor = "";
  #pointed: number | undefined;
  /** Whether values were left out because they have no logarithm. */
  isOffLogarithm = false;
  /** Whether a curve looks flat because another one is much larger. */
  hasFlatCurve = false;

  /** `changed` is called when the chart has another size, or the mouse points to another time. */
  constructor(changed: () => void) {
    this.element = h(
      "div",
      { class: "plot-canvas" },
      this.#frame,
      this.#strip.element,
      this.#cursor,
    );
    new ResizeObserver(() => {
      this.#width = this.element.clientWidth;
      this.#height = this.element.clientHeight;
      changed();
    }).observe(this.element);
    this.element.addEventListener("pointermove", ({ clientX }) => {
      const x = clientX - this.element.getBoundingClientRect().left;
      this.#cursor.hidden = x < this.#left || x > this.#width - MARGIN;
      this.#cursor.style.translate = `${x}px`;
      this.#pointed = this.#cursor.hidden ? undefined : x;
      changed();
    });
    this.element.addEventListener("pointerleave", () => {
      this.#cursor.hidden = true;
      this.#pointed = undefined;
      changed();
    });
  }

  /** The time under the mouse. */
  get pointed(): number | undefined {
    return this.#pointed === undefined ? undefined : this.#strip.timeAt(this.#pointed - this.#left);
  }

  /** The width of the curves in CSS pixels. */
  get width(): number {
    return Math.max(1, this.#width - this.#left);
  }

  /** The extent of the axis of each curve. */
  get extents(): readonly Extent[] {
    return this.#axes.map(({ extent }) => extent);
  }

  /** Show other curves, or show them in another style. */
  set(curves: readonly ChartCurve[], style: ChartStyle): void {
    this.#curves = curves;
    this.#style = style;
    this.#drawnFor = "";
    // What was found out about others; it is found out again if these are drawn.
    this.#axes = [];
    this.isOffLogarithm = false;
    this.hasFlatCurve = false;
  }

  /** Show the last `span` seconds before a time; while paused, with the time of day. */
  draw(now: number, span: number, isPaused: boolean): void {
    if (this.#curves.length === 0 || this.#width === 0) return;
    const shown = [this.#width, this.#height, devicePixelRatio, span, isPaused && now].join();
    const isNew = shown !== this.#drawnFor;
    // A sample outside its axis changes that at once.
    const fits =
      !isNew && this.#strip.pending(now).every(({ values }, at) => this.#fits(values, at));
    if (!fits || now - this.#lastAdapted > ADAPT) {
      const axes = this.#newAxes(now, span);
      this.#lastAdapted = now;
      const isSame = axes.every(({ extent: [low, high] }, at) => {
        const old = this.#axes[at]?.extent;
        return old?.[0] === low && old[1] === high;
      });
      if (isNew || !isSame) {
        this.#axes = axes;
        this.#drawnFor = shown;
        this.#redraw(now, span, isPaused);
        return;
      }
    }
    this.#strip.scroll(now);
  }

  #fits(values: Float64Array, at: number): boolean {
    const axis = this.#axes[at];
    return axis !== undefined && contains(axis.extent, this.#extent(values));
  }

  #extent(values: Float64Array): Extent {
    return extentOf(this.#style.logarithmic ? values.filter((value) => value > 0) : values);
  }

  #newAxes(now: number, span: number): Axis[] {
    const { logarithmic, separate } = this.#style;
    const curves = this.#curves.map(({ samples }) => {
      const { times, values } = samples.between(now - span, now, 2 * this.#width);
      return values.filter((_, at) => (times[at] as number) <= now);
    });
    const extents = curves.map((values) => this.#extent(values));
    const heights = extents.map(([low, high]) => high - low).filter((height) => height > 0);
    this.hasFlatCurve = !logarithmic && !separate && greatest(heights) > FLAT * least(heights);
    this.isOffLogarithm = logarithmic && curves.some((each) => each.some((value) => value <= 0));
    const parts = Math.max(2, Math.floor((this.#height - TIME_AXIS) / LABEL_HEIGHT));
    const axisFor = (extent: Extent): Axis =>
      logarithmic ? logarithmicAxis(extent, 1.5 * parts) : linearAxis(extent, parts);
    if (separate) return extents.map(axisFor);
    const shared = axisFor(union(extents));
    return extents.map(() => shared);
  }

  #redraw(now: number, span: number, isPaused: boolean): void {
    const scale = devicePixelRatio;
    this.#frame.width = Math.round(this.#width * scale);
    this.#frame.height = Math.round(this.#height * scale);
    const context = this.#frame.getContext("2d") as CanvasRenderingContext2D;
    context.scale(scale, scale);
    context.font = FONT;
    this.#left = this.#drawAxes(context);
    this.#drawTimes(context, now, span, isPaused);
    this.#strip.element.style.insetInlineStart = `${this.#left}px`;
    const strokes = this.#curves.map((curve, at) => this.#stroke(curve, this.#axes[at]));
    const height = this.#height - TIME_AXIS + MARGIN;
    this.#strip.redraw(strokes, this.width, height, now, span);
  }

  #stroke({ samples, style, colour }: ChartCurve, axis: Axis | undefined): Stroke {
    return { samples, style, colour, heightOf: this.#heightOf(axis?.extent ?? [0, 1]) };
  }

  /** The height of a value on an axis, from 0 to 1; NaN if the axis has no place for it. */
  #heightOf([low, high]: Extent): (value: number) => number {
    if (!this.#style.logarithmic) return (value) => (value - low) / (high - low);
    const [first, last] = [Math.log10(low), Math.log10(high)];
    return (value) => (value > 0 ? (Math.log10(value) - first) / (last - first) : NaN);
  }

  #yOf(height: number): number {
    return MARGIN + (1 - height) * (this.#height - TIME_AXIS - MARGIN);
  }

  /** Draw the vertical axes and the grid lines of the first; return their width. */
  #drawAxes(context: CanvasRenderingContext2D): number {
    const { separate, ink, line } = this.#style;
    context.textAlign = "right";
    context.textBaseline = "middle";
    let left = 0;
    for (const [at, axis] of (separate ? this.#axes : this.#axes.slice(0, 1)).entries()) {
      const labels = axis.ticks.map(axisText);
      const widths = labels.map((label) => context.measureText(label).width);
      // In steps, so that the curves rarely get another width.
      const width = Math.ceil((greatest(widths) + 2 * GAP) / 8) * 8;
      if (at > 0 && left + width > MAX_AXES * this.#width) break;
      left += width;
      const heightOf = this.#heightOf(axis.extent);
      context.fillStyle = separate ? (this.#curves[at]?.colour ?? ink) : ink;
      for (const [index, tick] of axis.ticks.entries())
        context.fillText(labels[index] ?? "", left - GAP, this.#yOf(heightOf(tick)));
    }
    const first = this.#axes[0];
    context.fillStyle = line;
    for (const tick of first?.ticks ?? []) {
      const y = Math.round(this.#yOf(this.#heightOf(first?.extent ?? [0, 1])(tick)));
      context.fillRect(left, y, this.#width - left - MARGIN, 1);
    }
    return left;
  }

  #drawTimes(
    context: CanvasRenderingContext2D,
    now: number,
    span: number,
    isPaused: boolean,
  ): void {
    const { ink, line } = this.#style;
    const right = this.#width - MARGIN;
    const width = right - this.#left;
    const step = timeStep(span, Math.max(1, width / LABEL_WIDTH));
    const last = isPaused ? Math.floor(now / step) * step : now;
    const bottom = this.#height - TIME_AXIS;
    context.textBaseline = "top";
    for (let time = last; time >= now - span; time -= step) {
      const x = Math.round(right - ((now - time) / span) * width);
      context.fillStyle = line;
      context.fillRect(x, MARGIN, 1, bottom - MARGIN + 4);
      context.fillStyle = ink;
      const label = isPaused ? clock(time) : agoText(Math.round(now - time));
      const half = context.measureText(label).width / 2;
      context.textAlign = "center";
      const centre = Math.min(this.#width - half, Math.max(this.#left + half, x));
      context.fillText(label, centre, bottom + GAP);
    }
  }
}
