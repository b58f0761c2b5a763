/**
 * Draws curves and their axes.
 *
 * uPlot draws the axes and has the cursor and the selection. The curves are on a canvas of their own,
 * which scrolls while time moves: the labels of the time axis are relative to now then, so that 20
 * curves move at a small part of the cost of drawing them.
 */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
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
  multiples,
  ticksIn,
  timeStep,
  union,
} from "./axes";
import { listen } from "./gestures";
import { type Points, pairs } from "./pairs";
import type { Curve } from "./sampler";
import { MARGIN, type Shape, Strip } from "./strip";

/** What is horizontal: the time, the index in arrays, or the values of the first curve. */
export type Across = "time" | "index" | "xy";

/** A curve and its look. */
export interface ChartCurve {
  readonly curve: Curve;
  readonly style: number;
  readonly colour: string;
}

export interface ChartStyle {
  /** The colours of text and of grid lines. */
  readonly ink: string;
  readonly line: string;
  readonly logarithmic: boolean;
  /** Whether the horizontal axis is logarithmic, unless it is the time. */
  readonly logarithmicAcross: boolean;
  /** Whether each curve has an axis of its own. */
  readonly separate: boolean;
  readonly shape: Shape;
  readonly across: Across;
}

/** What is seen of a curve: the ends of its values, and whether some have no logarithm. */
interface Seen {
  readonly extent: Extent;
  readonly isOff: boolean;
}

const FONT = "11px system-ui, sans-serif";
/** The height of the horizontal axis, and the space around labels. In CSS pixels. */
const X_AXIS = 20;
const GAP = 6;
/** The room beside the last label, in CSS pixels. */
const RIGHT = 20;
/** The minimum distances between labels, in CSS pixels. */
const LABEL_WIDTH = 84;
const LABEL_HEIGHT = 34;
/** The share of the width that axes may have; those of further curves are left out. */
const MAX_AXES = 0.4;
/** A curve looks flat if another one is as many times as high. */
const FLAT = 20;
/** Time after which axes are adapted to samples that are no longer visible, in seconds. */
const ADAPT = 0.5;
/** The shortest time that can be seen, and the longest beside what there is. In seconds. */
const MIN_SPAN = 1e-4;
/** The least distances in CSS pixels of a drag that zooms, and in both directions. */
const DRAG = 5;
const DRAG_BOTH = 30;

export class Chart {
  readonly element: HTMLElement;
  readonly #strip = new Strip();
  /** Where another plot's mouse is. */
  readonly #mark = h("div", { class: "plot-mark", hidden: true });
  readonly #changed: () => void;
  /** Ends the listeners of the current uPlot. */
  #listening = new AbortController();
  readonly #observer: ResizeObserver;
  #curves: readonly ChartCurve[] = [];
  #style: ChartStyle = NO_STYLE;
  #uplot: uPlot | undefined;
  #width = 0;
  #height = 0;
  #axes: Axis[] = [];
  #ticks: { readonly values: number[]; readonly labels: string[] } = { values: [], labels: [] };
  /** The ends of the horizontal axis as it is drawn. */
  #xs: Extent = [-1, 0];
  /** What the axes were last drawn for. */
  #drawnAxes = "";
  #lastAdapted = 0;
  /** What the curves were drawn for; everything is drawn again when it changes. */
  #drawnFor = "";
  /** What the user has zoomed to: of the horizontal axis, and of each vertical one. */
  #xView: Extent | undefined;
  #yView: readonly Extent[] | undefined;
  /** The time that the plot stands still at, during a drag of the mouse. */
  #held: number | undefined;
  /** What is shown without a zoom. */
  #whole: Extent = [-1, 0];
  /** Whether values were left out because they have no logarithm. */
  isOffLogarithm = false;
  /** Whether a curve looks flat because another one is much larger. */
  hasFlatCurve = false;

  /** `changed` is called when the chart has another size, zoom, or place of the mouse. */
  constructor(changed: () => void) {
    this.#changed = changed;
    this.element = h("div", {
      class: "plot-canvas",
      tabindex: 0,
      role: "group",
      "aria-label":
        "Chart: drag or wheel to zoom, Shift and drag to move; keys: arrows, plus, minus; Escape shows all",
    });
    this.#observer = new ResizeObserver(() => this.#resize());
    this.#observer.observe(this.element);
  }

  /** Free what it has. */
  close(): void {
    this.#observer.disconnect();
    this.#removeUplot();
  }

  /** The value of the horizontal axis under the mouse. */
  get pointed(): number | undefined {
    const { left = -1, top = -1 } = this.#uplot?.cursor ?? {};
    if (left < 0 || top < 0) return undefined;
    return this.#valueAt(left);
  }

  /** The width of the curves in CSS pixels. */
  get width(): number {
    return Math.max(1, this.#size[0]);
  }

  /** What the user has zoomed to on the horizontal axis. */
  get view(): Extent | undefined {
    return this.#xView;
  }

  get isZoomed(): boolean {
    return this.#xView !== undefined || this.#yView !== undefined;
  }

  /** Show other curves, or show them in another style. */
  set(curves: readonly ChartCurve[], style: ChartStyle): void {
    const hasOtherAxes =
      style.across !== this.#style.across ||
      style.separate !== this.#style.separate ||
      style.logarithmic !== this.#style.logarithmic ||
      (style.separate && curves.length !== this.#curves.length);
    if (style.across !== this.#style.across) this.#xView = undefined;
    if (hasOtherAxes) this.#yView = undefined;
    this.#curves = curves;
    this.#style = style;
    this.#drawnFor = "";
    // What was found out about others; it is found out again if these are drawn.
    this.#axes = [];
    this.isOffLogarithm = false;
    this.hasFlatCurve = false;
    this.#removeUplot();
  }

  /** Show all again. */
  readonly reset = (): void => {
    this.#xView = this.#yView = undefined;
    this.#changed();
  };

  /** Show where the mouse is in another plot; undefined if it is in none. */
  mark(time: number | undefined): void {
    const x = time === undefined ? -1 : this.#strip.positionOf(time);
    this.#mark.hidden = this.#style.across !== "time" || !(x >= 0 && x <= this.width);
    if (!this.#mark.hidden) this.#mark.style.translate = `${x}px`;
  }

  /** Show the last `span` seconds before a time, or what was zoomed to; with the time of day while paused. */
  draw(now: number, span: number, isPaused: boolean): void {
    if (this.#curves.length === 0 || this.#width === 0) return;
    const end = this.#held ?? now;
    if (this.#style.across === "time") this.#drawTime(end, span, isPaused);
    else this.#drawTracks(end, span);
  }

  // Curves over time.

  #drawTime(now: number, span: number, isPaused: boolean): void {
    this.#whole = [now - span, now];
    const isStill = isPaused || this.#xView !== undefined;
    const [from, to] = this.#xView ?? this.#whole;
    const shown = [this.#width, this.#height, devicePixelRatio, to - from, isStill && to].join();
    const isNew = isStill || shown !== this.#drawnFor;
    // A sample outside its axis changes that at once.
    const fits =
      !isNew && this.#strip.pending(now).every(({ values }, at) => this.#fits(values, at));
    if (!fits || now - this.#lastAdapted > ADAPT) {
      this.#lastAdapted = now;
      const axes = this.#newAxes(this.#curves.map(({ curve }) => this.#seen(curve, from, to, now)));
      if (isNew || !this.#hasAxes(axes)) {
        this.#axes = axes;
        this.#drawnFor = shown;
        this.#drawAxes(isStill ? [from, to] : [from - to, 0], isStill);
        this.#strip.redraw(
          this.#strokes(),
          this.#size,
          { from, to, until: now },
          this.#style.shape,
        );
        return;
      }
    }
    this.#strip.scroll(now);
  }

  /** The extent of a curve between two times, and whether there are values without a logarithm. */
  #seen({ samples }: Curve, from: number, to: number, until: number): Seen {
    const end = Math.min(to, until);
    if (!this.#style.logarithmic) return { extent: samples.extent(from, end), isOff: false };
    return this.#seenOf(samples.within(from, end).values);
  }

  #seenOf(values: Float64Array): Seen {
    const { logarithmic } = this.#style;
    return {
      extent: this.#extent(values),
      isOff: logarithmic && values.some((value) => value <= 0),
    };
  }

  #fits(values: Float64Array, at: number): boolean {
    if (this.#yView !== undefined) return true;
    const axis = this.#axes[at];
    return axis !== undefined && contains(axis.extent, this.#extent(values));
  }

  #strokes() {
    return this.#curves.map(({ curve: { samples }, style, colour }, at) => ({
      samples,
      style,
      colour,
      heightOf: this.#heightOf(at),
    }));
  }

  // Curves over something else.

  #drawTracks(now: number, span: number): void {
    const points = this.#points(now, span);
    const isLogarithmic = this.#style.logarithmicAcross;
    const seen = union(points.map(({ xs }) => extentOf(positive(xs, isLogarithmic))));
    const whole = isLogarithmic ? logarithmicAxis(seen, 6) : linearAxis(seen, 4);
    // An index begins at zero, and ends with the array.
    const isIndex = this.#style.across === "index" && !isLogarithmic;
    this.#whole = isIndex && seen[0] < seen[1] ? seen : whole.extent;
    const xs = this.#xView ?? this.#whole;
    const axes = this.#newAxes(
      points.map((each) => {
        const isSeen = (at: number): boolean =>
          (each.xs[at] as number) >= xs[0] && (each.xs[at] as number) <= xs[1];
        return this.#seenOf(each.ys.filter((_, at) => isSeen(at)));
      }),
    );
    this.#axes = axes;
    this.#drawAxes(xs, true);
    const tracks = points.map((each, at) => ({
      ...each,
      style: this.#curves[at]?.style ?? 0,
      colour: this.#curves[at]?.colour ?? "",
      heightOf: this.#heightOf(at),
    }));
    this.#strip.drawTracks(tracks, this.#size, placeOn(xs, isLogarithmic), this.#style.shape);
  }

  #points(now: number, span: number): Points[] {
    if (this.#style.across === "index") {
      return this.#curves.map(({ curve: { elements = NO_VALUES } }) => ({
        xs: Float64Array.from(elements, (_, at) => at),
        ys: elements,
      }));
    }
    const first = this.#curves[0]?.curve.samples;
    return this.#curves.map(({ curve: { samples } }, at) =>
      first === undefined || at === 0
        ? { xs: NO_VALUES, ys: NO_VALUES }
        : pairs(first, samples, now - span, now),
    );
  }

  // The axes.

  #extent(values: Float64Array): Extent {
    return extentOf(positive(values, this.#style.logarithmic));
  }

  /** The vertical axis of each curve, for the values that are seen. */
  #newAxes(seen: readonly Seen[]): Axis[] {
    const { logarithmic, separate } = this.#style;
    const extents = seen.map(({ extent }) => extent);
    const heights = extents.map(([low, high]) => high - low).filter((height) => height > 0);
    this.hasFlatCurve = !logarithmic && !separate && greatest(heights) > FLAT * least(heights);
    this.isOffLogarithm = seen.some(({ isOff }) => isOff);
    const parts = Math.max(2, Math.floor((this.#height - X_AXIS) / LABEL_HEIGHT));
    const axisFor = (extent: Extent, at: number): Axis => {
      const view = this.#yView?.[at];
      if (view !== undefined) return { extent: view, ticks: ticksIn(view, parts, logarithmic) };
      return logarithmic ? logarithmicAxis(extent, 1.5 * parts) : linearAxis(extent, parts);
    };
    if (separate) return extents.map(axisFor);
    const shared = axisFor(union(extents), 0);
    return extents.map(() => shared);
  }

  #hasAxes(axes: readonly Axis[]): boolean {
    return axes.every(({ extent: [low, high] }, at) => {
      const old = this.#axes[at]?.extent;
      return old?.[0] === low && old[1] === high;
    });
  }

  /** Draw the axes, unless they are there already. */
  #drawAxes(xs: Extent, isStill: boolean): void {
    this.#uplot ??= this.#makeUplot();
    const shown = JSON.stringify([xs, isStill, this.#axes, this.#width, this.#height]);
    if (shown === this.#drawnAxes) return;
    this.#drawnAxes = shown;
    this.#xs = xs;
    this.#ticks = this.#xTicks(xs, isStill);
    const uplot = this.#uplot;
    // At once, as the place of the curves depends on the width of the axes.
    uplot.batch(() => uplot.setScale("x", { min: xs[0], max: xs[1] }));
    this.#strip.element.classList.toggle("clipped", this.isZoomed);
  }

  #xTicks(xs: Extent, isStill: boolean): { values: number[]; labels: string[] } {
    const limit = Math.max(2, this.#width / LABEL_WIDTH);
    if (this.#style.across !== "time") {
      const values = ticksIn(xs, limit, this.#style.logarithmicAcross);
      return { values, labels: values.map(axisText) };
    }
    const step = timeStep(xs[1] - xs[0], limit);
    const values = multiples(xs, step);
    const digits = step >= 1 ? 1 : Math.ceil(-Math.log10(step) - 1e-9);
    const label = (time: number): string => (isStill ? clock(time, digits) : agoText(-time));
    return { values, labels: values.map(label) };
  }

  /** The height of the values of a curve, from 0 to 1; NaN if the axis has no place for it. */
  #heightOf(at: number): (value: number) => number {
    return placeOn(this.#axes[at]?.extent ?? [0, 1], this.#style.logarithmic);
  }

  // uPlot.

  #makeUplot(): uPlot {
    const { ink, line, separate, logarithmic, logarithmicAcross, across } = this.#style;
    const axes = separate ? this.#curves.map((_, at) => at) : [0];
    const scaleOf = (at: number): uPlot.Scale => ({
      // Asked for its range again with each new one of the horizontal axis.
      auto: true,
      distr: logarithmic ? 3 : 1,
      range: () => [...(this.#axes[at]?.extent ?? [0, 1])] as [number, number],
    });
    const frame = { font: FONT, gap: GAP, ticks: { show: false } };
    const uplot = new uPlot(
      {
        width: this.#width,
        height: this.#height,
        padding: [MARGIN, RIGHT, 0, 0],
        legend: { show: false },
        series: [{}, ...axes.map((at) => ({ scale: `y${at}`, show: true }))],
        scales: {
          x: {
            time: false,
            auto: false,
            distr: logarithmicAcross && across !== "time" ? 3 : 1,
            range: () => [...this.#xs] as [number, number],
          },
          ...Object.fromEntries(axes.map((at) => [`y${at}`, scaleOf(at)])),
        },
        axes: [
          {
            ...frame,
            scale: "x",
            stroke: ink,
            grid: { stroke: line, width: 1 },
            size: X_AXIS,
            splits: () => this.#ticks.values,
            values: () => this.#ticks.labels,
          },
          ...axes.map((at) => ({
            ...frame,
            scale: `y${at}`,
            side: 3 as const,
            show: at === 0 || (at + 1) * 48 < MAX_AXES * this.#width,
            stroke: separate ? (this.#curves[at]?.colour ?? ink) : ink,
            grid: { show: at === 0, stroke: line, width: 1 },
            size: axisWidth,
            splits: () => [...(this.#axes[at]?.ticks ?? [])],
            values: (_: uPlot, ticks: number[]) => ticks.map(axisText),
            filter: (_: uPlot, ticks: number[]) => ticks,
          })),
        ],
        cursor: {
          points: { show: false },
          drag: { x: true, y: true, dist: DRAG, uni: DRAG_BOTH, setScale: false },
          bind: {
            mousedown: (_u, _target, handle) => (event) => {
              if (event.button === 0 && !event.shiftKey) handle(event);
              return null;
            },
            dblclick: () => () => {
              this.reset();
              return null;
            },
          },
        },
        hooks: {
          setCursor: [() => this.#changed()],
          setSelect: [() => this.#zoomToSelection()],
        },
      },
      [[], ...axes.map(() => [])] as unknown as uPlot.AlignedData,
      this.element,
    );
    this.#drawnAxes = "";
    uplot.over.prepend(this.#strip.element);
    uplot.over.append(this.#mark);
    this.#listening = new AbortController();
    const { signal } = this.#listening;
    uplot.over.addEventListener("mousedown", () => this.#hold(), { signal });
    listen(uplot.over, this.element, this.#gestures, signal);
    return uplot;
  }

  #removeUplot(): void {
    this.#listening.abort();
    this.#uplot?.destroy();
    this.#uplot = undefined;
  }

  /** The size of the curves in CSS pixels. */
  get #size(): [width: number, height: number] {
    const { width = 1, height = 1 } = this.#uplot?.bbox ?? {};
    return [width / devicePixelRatio, height / devicePixelRatio];
  }

  #resize(): void {
    this.#width = this.element.clientWidth;
    this.#height = this.element.clientHeight;
    if (this.#width > 0) this.#uplot?.setSize({ width: this.#width, height: this.#height });
    this.#changed();
  }

  // Zoom and pan.

  readonly #gestures = {
    pan: (dx: number, dy: number): void => {
      this.#showPart(-dx, this.width - dx);
      if (dy === 0) return;
      const height = this.#size[1];
      this.#showHeights(-dy, height - dy);
    },
    zoom: (factor: number, x = this.width / 2): void =>
      this.#showPart(x - x * factor, x + (this.width - x) * factor),
    reset: this.reset,
  };

  /** Stand still until the mouse is released. */
  #hold(): void {
    if (this.#style.across !== "time" || this.#xView !== undefined) return;
    this.#held = this.#whole[1];
    const { signal } = this.#listening;
    const release = (): void => {
      this.#held = undefined;
      this.#changed();
    };
    window.addEventListener("mouseup", release, { once: true, signal });
  }

  #zoomToSelection(): void {
    const uplot = this.#uplot;
    if (uplot === undefined) return;
    const { left, top, width, height } = uplot.select;
    uplot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    const [wide, high] = this.#size;
    if (width > 0 && width < wide - 1) this.#showPart(left, left + width);
    if (height > 0 && height < high - 1) this.#showHeights(top, top + height);
  }

  /** Show the part between two positions in CSS pixels. */
  #showPart(left: number, right: number): void {
    const [from, to] = [this.#valueAt(left), this.#valueAt(right)];
    if (!(to - from > MIN_SPAN) && this.#style.across === "time") return;
    if (!(to > from) || !Number.isFinite(to - from)) return;
    this.#xView = [from, to];
    this.#changed();
  }

  #showHeights(top: number, bottom: number): void {
    const high = this.#size[1];
    const isLogarithmic = this.#style.logarithmic;
    const views = this.#axes.map(({ extent }): Extent => {
      const at = (y: number): number => valueOn(extent, 1 - y / high, isLogarithmic);
      return [at(bottom), at(top)];
    });
    if (!views.every(([from, to]) => to > from && Number.isFinite(to - from))) return;
    this.#yView = views;
    this.#changed();
  }

  /** The value of the horizontal axis at a position in CSS pixels. */
  #valueAt(x: number): number {
    if (this.#style.across === "time") return this.#strip.timeAt(x);
    return valueOn(this.#xs, x / this.width, this.#style.logarithmicAcross);
  }
}

const NO_VALUES = new Float64Array();

const NO_STYLE: ChartStyle = {
  ink: "",
  line: "",
  logarithmic: false,
  logarithmicAcross: false,
  separate: false,
  shape: "lines",
  across: "time",
};

/** The place of a value between the ends of an axis, from 0 to 1. */
function placeOn([low, high]: Extent, isLogarithmic: boolean): (value: number) => number {
  if (!isLogarithmic) return (value) => (value - low) / (high - low);
  const [first, last] = [Math.log10(low), Math.log10(high)];
  return (value) => (value > 0 ? (Math.log10(value) - first) / (last - first) : NaN);
}

function valueOn([low, high]: Extent, place: number, isLogarithmic: boolean): number {
  if (!isLogarithmic) return low + place * (high - low);
  const [first, last] = [Math.log10(low), Math.log10(high)];
  return 10 ** (first + place * (last - first));
}

function positive<T extends Float64Array>(values: T, isLogarithmic: boolean): Float64Array {
  return isLogarithmic ? values.filter((value) => value > 0) : values;
}

/** The width of a vertical axis: in steps, so that the curves rarely get another one. */
function axisWidth({ ctx }: uPlot, labels: string[] | null): number {
  ctx.save();
  ctx.font = FONT;
  const widths = (labels ?? ["0"]).map((label) => ctx.measureText(label).width);
  ctx.restore();
  return Math.ceil((greatest(widths) + 2 * GAP) / 8) * 8;
}
