/** Laser scans as points. */
import type { Fields } from "../../../messages/reader";
import { floats } from "../../../messages/values";
import type { Vector } from "../../../transforms";
import { parseColor, percentiles } from "../colors";
import {
  firstProblems,
  type Header,
  type Hit,
  type Layer,
  type LayerContext,
  type Places,
  type Pointer,
  type Problems,
  type View,
} from "../layer";
import { corners, nearestPoint } from "../picking";
import { type Paint, renderer, Vertices } from "../renderer";

/** Numbers of a point: x, y, z, and from there on the range and the intensity. */
const NUMBERS = 5;
const [RANGE, INTENSITY] = [12, 16];
/** Scans that are kept at most, however long they stay. */
const MAX_SCANS = 500;

/** The points of one scan. */
interface Scan {
  readonly header: Header;
  readonly numbers: Float32Array;
  readonly count: number;
  /** Of the ranges, and of the intensities. */
  readonly limits: readonly [readonly [number, number], readonly [number, number]];
  readonly vertices: Vertices;
  readonly arrived: number;
}

export class LaserScan implements Layer {
  readonly #context: LayerContext;
  #scans: Scan[] = [];
  #facts = "";

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields, now: number): void {
    const { numbers, count, nearest } = scanPoints(message);
    const value = (at: number) => (index: number) => numbers[index * NUMBERS + at / 4] as number;
    const limits = [
      percentiles(count, value(RANGE)),
      percentiles(count, value(INTENSITY)),
    ] as const;
    const decay = Number(this.#context.settings.decay) * 1000;
    const gone = this.#scans.findIndex(({ arrived }) => arrived > now - decay);
    const first = Math.max(
      gone < 0 ? this.#scans.length : gone,
      this.#scans.length - MAX_SCANS + 1,
    );
    const old = this.#scans.splice(0, first);
    // The memory of one scan that ends is that of the next.
    const vertices = old.pop()?.vertices ?? new Vertices();
    for (const scan of old) scan.vertices.close();
    vertices.set(numbers.subarray(0, count * NUMBERS));
    const header = message.header as Header;
    this.#scans.push({ header, numbers, count, limits, vertices, arrived: now });
    this.#facts = `${count} points`;
    if (nearest !== undefined) {
      const degrees = Math.round((nearest.angle * 180) / Math.PI);
      this.#facts += `, nearest ${nearest.range.toFixed(2)} m at ${degrees}°`;
    }
  }

  draw(view: View): void {
    for (const scan of this.#scans) {
      const model = view.place(scan.header);
      if (model === undefined) continue;
      const { vertices, count } = scan;
      const size = Number(this.#context.settings.size);
      const points = { vertices, count, stride: NUMBERS * 4, size, paint: this.#paint(scan) };
      renderer.points(points, model);
    }
  }

  #paint({ limits }: Scan): Paint {
    const { color, flat, palette } = this.#context.settings;
    if (color === "flat") return { kind: "flat", color: parseColor(String(flat)) };
    const isRange = color === "range";
    const [low, high] = limits[isRange ? 0 : 1];
    return {
      kind: "number",
      offset: isRange ? RANGE : INTENSITY,
      type: "float32",
      palette: palette as "turbo",
      low,
      high,
    };
  }

  problems(places: Places): Problems {
    return firstProblems(this.#scans.toReversed().map(({ header }) => places.locate(header)));
  }

  facts(): string {
    return this.#facts;
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const scan = this.#scans.at(-1);
    const model = scan && view.place(scan.header);
    if (scan === undefined || model === undefined) return undefined;
    const { numbers, count } = scan;
    const used = numbers.subarray(0, count * NUMBERS);
    const near = nearestPoint(view, pointer, model, used, NUMBERS);
    if (near === undefined) return undefined;
    const [x = 0, y = 0, , range = 0, intensity = 0] = used.subarray(near.index * NUMBERS);
    const degrees = (Math.atan2(y, x) * 180) / Math.PI;
    const parts = [`${range.toFixed(2)} m at ${degrees.toFixed(1)}°`];
    if (!Number.isNaN(intensity)) parts.push(`intensity ${Number(intensity.toPrecision(4))}`);
    return { distance: near.distance, place: near.place, text: parts.join(", ") };
  }

  extent(view: View): Vector[] {
    const scan = this.#scans.at(-1);
    const model = scan && view.place(scan.header);
    return scan === undefined || model === undefined
      ? []
      : corners(scan.numbers.subarray(0, scan.count * NUMBERS), NUMBERS, model);
  }

  close(): void {
    for (const { vertices } of this.#scans) vertices.close();
  }
}

/** The points of a scan, with one or several echoes; rays that have seen nothing are left out. */
export function scanPoints(message: Fields): {
  numbers: Float32Array;
  count: number;
  nearest: { range: number; angle: number } | undefined;
} {
  const { angle_min, angle_increment, range_min, range_max } = message as Record<string, number>;
  const [first] = (message.ranges ?? []) as ArrayLike<unknown> & Iterable<unknown>;
  const isMulti = typeof first === "object" && first !== null;
  const ranges = isMulti ? echoes(message.ranges) : [floats(message.ranges)];
  const strengths = isMulti ? echoes(message.intensities) : [floats(message.intensities)];
  const total = ranges.reduce((sum, each) => sum + each.length, 0);
  const numbers = new Float32Array(total * NUMBERS);
  let count = 0;
  let nearest: { range: number; angle: number } | undefined;
  for (const [ray, values] of ranges.entries()) {
    for (let index = 0; index < values.length; index += 1) {
      const range = values[index] as number;
      if (!(range >= (range_min ?? 0) && range <= (range_max ?? 0) && range < Infinity)) continue;
      const angle = (angle_min ?? 0) + (isMulti ? ray : index) * (angle_increment ?? 0);
      if (nearest === undefined || range < nearest.range) nearest = { range, angle };
      const at = count * NUMBERS;
      numbers[at] = range * Math.cos(angle);
      numbers[at + 1] = range * Math.sin(angle);
      numbers[at + 3] = range;
      numbers[at + 4] = strengths[ray]?.[index] ?? Number.NaN;
      count += 1;
    }
  }
  return { numbers, count, nearest };
}

/** The numbers of each ray of a sensor_msgs/MultiEchoLaserScan. */
function echoes(value: unknown): Float32Array[] {
  return (value as { echoes: unknown }[]).map((each) => floats(each.echoes));
}
