/** The ranges, ticks and labels of a plot's axes. */
import { timeOfDay } from "../format";

export type Extent = readonly [low: number, high: number];

/** A vertical axis: the values at its ends, and those with a label. */
export interface Axis {
  readonly extent: Extent;
  readonly ticks: readonly number[];
}

/** The extent of no values. */
export const NOTHING: Extent = [Infinity, -Infinity];
/** The first digits of the distance between two ticks. */
const NICE = [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10];
/** Possible times between two labels of the time axis, in seconds. */
const SECONDS = [
  ...[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1].flatMap((power) => [power, 2 * power, 5 * power]),
  ...[1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600],
];
/** Lengths of the time axis before it has grown to the chosen one, in seconds. */
const GROWING = [2, 5, 10, 20, 30, 60, 120, 300];

/** The least and the greatest of some values, without those that are not finite. */
export function extentOf(values: Iterable<number>): Extent {
  let [least, greatest] = NOTHING;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    if (value < least) least = value;
    if (value > greatest) greatest = value;
  }
  return [least, greatest];
}

/** An extent that includes others. */
export function union(extents: readonly Extent[]): Extent {
  return extentOf(extents.flat());
}

/** Whether all values are within an extent. */
export function contains([low, high]: Extent, [least, greatest]: Extent): boolean {
  return least > greatest || (low <= least && greatest <= high);
}

/**
 * A linear axis for some values, with ticks at round numbers that divide it into equal parts.
 *
 * The ticks of all axes with as many parts are at the same heights.
 */
export function linearAxis([least, greatest]: Extent, parts: number): Axis {
  if (least > greatest) return evenTicks(0, 1 / parts, parts);
  const half = least === 0 ? 1 : Math.abs(least) / 2;
  const [low, high] = least === greatest ? [least - half, least + half] : [least, greatest];
  const power = 10 ** Math.floor(Math.log10((high - low) / parts));
  for (const scale of [power, 10 * power]) {
    for (const digits of NICE) {
      const step = digits * scale;
      const first = Math.floor(low / step + 1e-9);
      if (first + parts >= high / step - 1e-9) return evenTicks(first * step, step, parts);
    }
  }
  // Huge numbers have no round numbers between them.
  return evenTicks(low, (high - low) / parts, parts);
}

function evenTicks(low: number, step: number, parts: number): Axis {
  const ticks = Array.from({ length: parts + 1 }, (_, at) =>
    Number((low + at * step).toPrecision(15)),
  );
  return { extent: [ticks[0] ?? low, ticks.at(-1) ?? low + parts * step], ticks };
}

/** A logarithmic axis for some positive values, with about `limit` ticks. */
export function logarithmicAxis([least, greatest]: Extent, limit: number): Axis {
  const low = least > greatest ? 0 : Math.floor(Math.log10(least));
  const high = Math.max(low + 1, least > greatest ? 1 : Math.ceil(Math.log10(greatest)));
  const parts = 3 * (high - low) <= limit ? [1, 2, 5] : [1];
  const stride = Math.max(1, Math.ceil((high - low) / limit));
  const ticks: number[] = [];
  for (let power = low; power <= high; power += stride) {
    for (const part of parts) if (power < high || part === 1) ticks.push(part * 10 ** power);
  }
  return { extent: [10 ** low, 10 ** high], ticks };
}

/**
 * The length of the time axis in seconds, for samples since `age` seconds ago.
 *
 * It grows in steps, as the whole plot is drawn again at each.
 */
export function spanFor(age: number, longest: number): number {
  return Math.min(longest, GROWING.find((span) => span >= age) ?? longest);
}

/** The distance in seconds between labels of the time axis, at most `limit` of them. */
export function timeStep(span: number, limit: number): number {
  return SECONDS.find((step) => span / step <= limit) ?? span;
}

/** Round values between two others, about `limit` of them. */
export function ticksIn([low, high]: Extent, limit: number, isLogarithmic = false): number[] {
  if (isLogarithmic && low > 0) {
    const ticks = logarithmicAxis([low, high], limit).ticks;
    const inside = ticks.filter((tick) => low <= tick && tick <= high);
    if (inside.length > 1) return inside;
  }
  const power = 10 ** Math.floor(Math.log10((high - low) / limit));
  const digits = [1, 2, 5, 10].find((each) => (high - low) / (each * power) <= limit) ?? 10;
  return multiples([low, high], digits * power);
}

/** The multiples of a step between two values. */
export function multiples([low, high]: Extent, step: number): number[] {
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.max(0, Math.floor(high / step + 1e-9) - first + 1);
  return Array.from({ length: count }, (_, at) => Number(((first + at) * step).toPrecision(15)));
}

/** A label for a time some seconds ago: `now`, `−5 s`, `−2 min`. */
export function agoText(ago: number): string {
  // Sums of steps are not exact.
  const seconds = Number(ago.toFixed(6));
  if (seconds === 0) return "now";
  return seconds % 60 === 0 ? `−${seconds / 60} min` : `−${seconds} s`;
}

/** The local time of day, with tenths of a second, or more digits, if it has any: `20:35:15`. */
export function clock(secs: number, digits = 1): string {
  const power = 10 ** digits;
  const parts = Math.round(secs * power);
  const text = timeOfDay(Math.floor(parts / power));
  const rest = parts % power;
  return rest === 0 ? text : `${text}.${String(rest).padStart(digits, "0").replace(/0+$/, "")}`;
}

/** A short label for a value: `1200`, `0.25`, `1.8e9`. */
export function axisText(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4))
    return value.toExponential(6).replace(/\.?0+e\+?/, "e");
  return String(Number(value.toPrecision(8)));
}
