/** Curves on a canvas that scrolls: of each curve, only what is new is drawn. */
import { DASHES, MARKERS } from "./curve_style";
import type { RingBuffer, Samples } from "./ring_buffer";

/** The look of a curve: the number of its dashes and marker, and its colour. */
export interface Look {
  readonly style: number;
  readonly colour: string;
}

/** A curve to draw: its samples, its look, and the height of a value, from 0 (bottom) to 1 (top). */
export interface Stroke extends Look {
  readonly samples: RingBuffer;
  readonly heightOf: (value: number) => number;
}

/** Room for markers: at the right of the newest samples, above and below the axes. In CSS pixels. */
export const MARGIN = 7;
/** The distances from which samples are drawn as dots, and between markers. In CSS pixels. */
const DOTS = 14;
const MARKER_DISTANCE = 120;
const LINE = 2;
const DOT = 2.5;
const MARKER = 4.5;

/** Where the drawing of a curve goes on. Positions are those on the canvas. */
interface Pen {
  readonly stroke: Stroke;
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
  #scale = 1;
  #pixelsPerSecond = 1;
  /** The time at the right end when everything was drawn, and by how many pixels it moved since. */
  #start = 0;
  #moved = 0;

  /** The samples up to a time that are not drawn yet, of each curve. */
  pending(now: number): Samples[] {
    return this.#pens.map(({ next, stroke }) =>
      stroke.samples.slice(next, stroke.samples.after(now)),
    );
  }

  /** Draw all curves on a canvas of a size in CSS pixels, with the last `span` seconds before `now`. */
  redraw(strokes: readonly Stroke[], width: number, height: number, now: number, span: number) {
    this.#scale = devicePixelRatio;
    // Setting its size clears the canvas.
    this.element.width = Math.round(width * this.#scale);
    this.element.height = Math.round(height * this.#scale);
    this.element.style.width = `${width}px`;
    this.element.style.height = `${height}px`;
    const plotted = Math.max(1, this.#right);
    this.#pixelsPerSecond = plotted / span;
    this.#start = now;
    this.#moved = 0;
    this.#pens = strokes.map((stroke) => ({
      stroke,
      next: stroke.samples.after(now),
      x: 0,
      y: NaN,
      length: 0,
      marker: -Infinity,
    }));
    for (const pen of this.#pens) {
      const { times, values } = pen.stroke.samples.between(now - span, now, 2 * plotted);
      const count = times.findLastIndex((time) => time <= now) + 1;
      this.#extend(pen, { times: times.subarray(0, count), values: values.subarray(0, count) });
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
      pen.next = pen.stroke.samples.after(now);
      const samples = pending[at];
      if (samples !== undefined && samples.times.length > 0) this.#extend(pen, samples);
    });
  }

  /** The time at a position in CSS pixels. */
  timeAt(x: number): number {
    const pixels = x * this.#scale - this.#right + this.#moved;
    return this.#start + pixels / this.#pixelsPerSecond;
  }

  /** The position of the newest time, in the canvas's own pixels. */
  get #right(): number {
    return this.element.width - Math.round(MARGIN * this.#scale);
  }

  #extend(pen: Pen, { times, values }: Samples): void {
    const context = this.#context;
    const { colour, style, heightOf } = pen.stroke;
    const dashes = DASHES[style] ?? [];
    const right = this.#right;
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
    for (let at = 0; at < times.length; at += 1) {
      const x = right + ((times[at] as number) - this.#start) * this.#pixelsPerSecond - this.#moved;
      const y = top + (1 - heightOf(values[at] as number)) * height;
      if (Number.isFinite(y)) {
        const isApart = Number.isNaN(pen.y) || x - pen.x >= DOTS * this.#scale;
        if (Number.isNaN(pen.y)) {
          context.moveTo(x, y);
        } else {
          context.lineTo(x, y);
          pen.length += Math.hypot(x - pen.x, y - pen.y);
        }
        if (x - pen.marker >= MARKER_DISTANCE * this.#scale) {
          markers.push([x, y]);
          pen.marker = x;
        } else if (isApart) {
          dots.push([x, y]);
        }
      }
      pen.x = x;
      pen.y = Number.isFinite(y) ? y : NaN;
    }
    context.stroke();
    context.beginPath();
    for (const [x, y] of dots) {
      context.moveTo(x, y);
      context.arc(x, y, DOT * this.#scale, 0, 2 * Math.PI);
    }
    context.fill();
    for (const [x, y] of markers) {
      const size = MARKER * this.#scale;
      context.beginPath();
      for (const [dx, dy] of MARKERS[style] ?? []) context.lineTo(x + size * dx, y + size * dy);
      context.fill();
    }
  }
}
