/** Curves on a canvas. While time moves, the canvas scrolls: of each curve, only what is new is drawn. */
import { dashesOf, markerOf } from "./curve_style";
import type { RingBuffer, Samples } from "./ring_buffer";

/** How samples are connected. */
export type Shape = "lines" | "steps" | "points";

/** The look of a curve: the number of its dashes and marker, and its colour. */
export interface Look {
  readonly style: number;
  readonly colour: string;
  /** The height of a value, from 0 (bottom) to 1 (top). */
  readonly heightOf: (value: number) => number;
}

/** A curve over time. */
export interface Stroke extends Look {
  readonly samples: RingBuffer;
}

/** A curve over something else. */
export interface Track extends Look {
  readonly xs: ArrayLike<number>;
  readonly ys: ArrayLike<number>;
}

/** What part of the time is on the canvas, in seconds; samples after `until` are not shown. */
export interface TimeWindow {
  readonly from: number;
  readonly to: number;
  readonly until: number;
}

/** Room for markers: at the right of the newest samples, above and below the axes. In CSS pixels. */
export const MARGIN = 7;
/** The distances from which samples are drawn as dots, and between markers. In CSS pixels. */
const DOTS = 14;
const MARKER_DISTANCE = 120;
const LINE = 2;
const DOT = 2.5;
const POINT = 3;
const MARKER = 4.5;
/** Samples nearer than this to the one before are left out, in the canvas's own pixels. */
const SAME = 0.5;

/** Where the drawing of a curve goes on. Positions are those on the canvas. */
interface Pen {
  readonly look: Look;
  readonly samples: RingBuffer | undefined;
  /** The index of the first sample that is not drawn yet. */
  next: number;
  x: number;
  /** NaN in a gap. */
  y: number;
  /** How long the line is so far, so that its dashes go on. */
  length: number;
  /** The position of the last marker. */
  marker: number;
}

export class Strip {
  readonly element = document.createElement("canvas");
  readonly #context = this.element.getContext("2d") as CanvasRenderingContext2D;
  #pens: Pen[] = [];
  #shape: Shape = "lines";
  #scale = 1;
  #pixelsPerSecond = 1;
  /** The time at the right end when everything was drawn, and by how many pixels it moved since. */
  #start = 0;
  #moved = 0;

  /** The samples up to a time that are not drawn yet, of each curve. */
  pending(now: number): Samples[] {
    return this.#pens.map(
      ({ next, samples }) => samples?.slice(next, samples.after(now)) ?? NO_SAMPLES,
    );
  }

  /** Draw curves over a part of the time, in a plot of a size in CSS pixels. */
  redraw(
    strokes: readonly Stroke[],
    [width, height]: readonly [number, number],
    { from, to, until }: TimeWindow,
    shape: Shape,
  ): void {
    this.#clear(width, height, shape);
    const plotted = Math.max(1, this.#right);
    this.#pixelsPerSecond = plotted / (to - from);
    this.#start = to;
    this.#pens = strokes.map((stroke) =>
      newPen(stroke, stroke.samples, stroke.samples.after(Math.min(to, until))),
    );
    for (const [at, pen] of this.#pens.entries()) {
      const samples = strokes[at]?.samples.between(from, to, 2 * plotted) ?? NO_SAMPLES;
      const count = samples.times.findLastIndex((time) => time <= until) + 1;
      this.#extendInTime(pen, {
        times: samples.times.subarray(0, count),
        values: samples.values.subarray(0, count),
      });
    }
  }

  /** Draw curves over something else, whose place is 0 (left) to 1 (right). */
  drawTracks(
    tracks: readonly Track[],
    [width, height]: readonly [number, number],
    placeOf: (value: number) => number,
    shape: Shape,
  ): void {
    this.#clear(width, height, shape);
    const right = this.#right;
    this.#pens = tracks.map((track) => newPen(track, undefined, 0));
    for (const [at, { xs, ys }] of tracks.entries()) {
      const pen = this.#pens[at] as Pen;
      this.#extend(pen, xs.length, (index) => right * placeOf(xs[index] as number), ys);
    }
  }

  /** Scroll to a time, and draw the samples since the last time. */
  scroll(now: number): void {
    const moved = Math.floor((now - this.#start) * this.#pixelsPerSecond);
    const shift = moved - this.#moved;
    if (shift > 0) {
      // This also clears the rest.
      this.#context.globalCompositeOperation = "copy";
      this.#context.drawImage(this.element, -shift, 0);
      this.#context.globalCompositeOperation = "source-over";
      this.#moved = moved;
    }
    const pending = this.pending(now);
    this.#pens.forEach((pen, at) => {
      pen.x -= Math.max(0, shift);
      pen.marker -= Math.max(0, shift);
      pen.next = pen.samples?.after(now) ?? 0;
      const samples = pending[at];
      if (samples !== undefined && samples.times.length > 0) this.#extendInTime(pen, samples);
    });
  }

  /** The time at a position in CSS pixels. */
  timeAt(x: number): number {
    const pixels = x * this.#scale - this.#right + this.#moved;
    return this.#start + pixels / this.#pixelsPerSecond;
  }

  /** The position of a time in CSS pixels. */
  positionOf(time: number): number {
    const pixels = (time - this.#start) * this.#pixelsPerSecond + this.#right - this.#moved;
    return pixels / this.#scale;
  }

  /** The position of the newest time, in the canvas's own pixels. */
  get #right(): number {
    return this.element.width - Math.round(MARGIN * this.#scale);
  }

  #clear(width: number, height: number, shape: Shape): void {
    this.#scale = devicePixelRatio;
    const [wide, high] = [width + MARGIN, height + 2 * MARGIN];
    // Setting its size clears the canvas.
    this.element.width = Math.round(wide * this.#scale);
    this.element.height = Math.round(high * this.#scale);
    this.element.style.width = `${wide}px`;
    this.element.style.height = `${high}px`;
    this.#moved = 0;
    this.#shape = shape;
  }

  #extendInTime(pen: Pen, { times, values }: Samples): void {
    const [right, start, rate] = [this.#right - this.#moved, this.#start, this.#pixelsPerSecond];
    const xOf = (at: number): number => right + ((times[at] as number) - start) * rate;
    this.#extend(pen, times.length, xOf, values);
  }

  /** Draw a curve on, by the positions and the values of its next samples. */
  #extend(pen: Pen, count: number, xOf: (at: number) => number, values: ArrayLike<number>): void {
    const context = this.#context;
    const { colour, style, heightOf } = pen.look;
    const [isStepped, isDotted] = [this.#shape === "steps", this.#shape === "points"];
    const dashes = dashesOf(style);
    const top = MARGIN * this.#scale;
    const height = this.element.height - 2 * top;
    const dots: [x: number, y: number][] = [];
    const markers: [x: number, y: number][] = [];
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = LINE * this.#scale;
    context.lineJoin = "round";
    // Round ends hide where parts of a curve meet; they would close small gaps between dashes.
    context.lineCap = dashes.length === 0 ? "round" : "butt";
    context.setLineDash(dashes.map((length) => length * this.#scale));
    context.lineDashOffset = pen.length;
    context.beginPath();
    context.moveTo(pen.x, pen.y);
    for (let at = 0; at < count; at += 1) {
      const x = xOf(at);
      const y = top + (1 - heightOf(values[at] as number)) * height;
      if (Math.abs(x - pen.x) < SAME && Math.abs(y - pen.y) < SAME) continue;
      if (Number.isFinite(x) && Number.isFinite(y)) {
        const isApart = Number.isNaN(pen.y) || Math.abs(x - pen.x) >= DOTS * this.#scale;
        if (Number.isNaN(pen.y)) {
          context.moveTo(x, y);
        } else {
          if (isStepped) context.lineTo(x, pen.y);
          context.lineTo(x, y);
          pen.length += isStepped
            ? Math.abs(x - pen.x) + Math.abs(y - pen.y)
            : Math.hypot(x - pen.x, y - pen.y);
        }
        if (Math.abs(x - pen.marker) >= MARKER_DISTANCE * this.#scale) {
          markers.push([x, y]);
          pen.marker = x;
        } else if (isApart || isDotted) {
          dots.push([x, y]);
        }
        pen.y = y;
      } else {
        pen.y = NaN;
      }
      pen.x = x;
    }
    if (!isDotted) context.stroke();
    this.#drawDots(dots, isDotted);
    context.beginPath();
    for (const [x, y] of markers) {
      const size = MARKER * this.#scale;
      context.beginPath();
      for (const [dx, dy] of markerOf(style)) context.lineTo(x + size * dx, y + size * dy);
      context.fill();
    }
  }

  /** Draw dots at the ends of lines, or squares if there are nothing but points: those may be many. */
  #drawDots(dots: readonly (readonly [x: number, y: number])[], areSquares: boolean): void {
    const context = this.#context;
    if (areSquares) {
      const size = POINT * this.#scale;
      for (const [x, y] of dots) context.fillRect(x - size / 2, y - size / 2, size, size);
      return;
    }
    context.beginPath();
    for (const [x, y] of dots) {
      context.moveTo(x, y);
      context.arc(x, y, DOT * this.#scale, 0, 2 * Math.PI);
    }
    context.fill();
  }
}

const NO_SAMPLES: Samples = { times: new Float64Array(), values: new Float64Array() };

function newPen(look: Look, samples: RingBuffer | undefined, next: number): Pen {
  return { look, samples, next, x: 0, y: NaN, length: 0, marker: -Infinity };
}
