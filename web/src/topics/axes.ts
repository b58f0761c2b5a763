/** The ranges, ticks and labels of a plot's axes. */
import { timeOfDay } from "../format";
import type { Samples } from "./ring_buffer";

export type Extent = readonly [low: number, high: number];

/** The margin above and below the curves, as a fraction of their height. */
const MARGIN = 0.08;

/** The range of the values from a time on, with a margin. */
export function linearExtent(curves: readonly Samples[], from: number): Extent {
  const [least, greatest] = extent(curves, from);
  if (least > greatest) return [0, 1];
  const height = greatest - least;
  if (height === 0) {
    const half = least === 0 ? 1 : Math.abs(least) / 2;
    return [least - half, greatest + half];
  }
  // A curve that starts at zero touches the axis.
  const below = least === 0 ? 0 : MARGIN * height;
  return [least - below, greatest + MARGIN * height];
}

/** The range of the positive values, extended to powers of ten. */
export function logarithmicExtent(curves: readonly Samples[], from: number): Extent {
  const [least, greatest] = extent(curves, from);
  if (least > greatest) return [1, 10];
  const low = 10 ** Math.floor(Math.log10(least));
  const high = 10 ** Math.ceil(Math.log10(greatest));
  return [low, high > low ? high : 10 * low];
}

/** About `limit` ticks of a logarithmic axis: powers of ten, with 2 and 5 if there is room. */
export function logarithmicTicks([least, greatest]: Extent, limit: number): number[] {
  const low = Math.round(Math.log10(least));
  const high = Math.round(Math.log10(greatest));
  const parts = 3 * (high - low) <= limit ? [1, 2, 5] : [1];
  const stride = Math.max(1, Math.ceil((high - low) / limit));
  const ticks: number[] = [];
  for (let power = low; power <= high; power += stride) {
    for (const part of parts) if (power < high || part === 1) ticks.push(part * 10 ** power);
  }
  return ticks;
}

function extent(curves: readonly Samples[], from: number): Extent {
  let least = Infinity;
  let greatest = -Infinity;
  for (const { times, values } of curves) {
    values.forEach((value, at) => {
      // The last sample before the window counts, as the line from there is visible.
      if ((times[at + 1] ?? Infinity) < from || !Number.isFinite(value)) return;
      if (value < least) least = value;
      if (value > greatest) greatest = value;
    });
  }
  return [least, greatest];
}

/** How many values a logarithmic axis cannot show. */
export function notPositive(curves: readonly Samples[]): number {
  return curves.reduce((sum, { values }) => sum + values.filter((value) => value <= 0).length, 0);
}

/** The local time of day, with tenths of a second if it has any: `20:35:15`. */
export function clock(secs: number): string {
  const fraction = Math.round((secs % 1) * 10);
  const text = timeOfDay(secs);
  return fraction % 10 === 0 ? text : `${text}.${fraction}`;
}

/** A short label for a value: `1200`, `0.25`, `1.8e9`. */
export function axisText(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4))
    return value.toExponential(6).replace(/\.?0+e\+?/, "e");
  return String(Number(value.toPrecision(8)));
}
