/** The points of an x-y plot: the values of two curves at the same times. */
import type { RingBuffer } from "./ring_buffer";

export interface Points {
  readonly xs: Float64Array;
  readonly ys: Float64Array;
}

/**
 * Pair the samples of a curve between two times with those of another one, which is the horizontal.
 *
 * Samples of one message have the same time; those of several topics get the newest value until then.
 */
export function pairs(across: RingBuffer, up: RingBuffer, from: number, to: number): Points {
  const { times, values } = up.within(from, to);
  // With the last one before.
  const x = across.between(from, to, Infinity);
  const xs = new Float64Array(times.length).fill(Number.NaN);
  let at = -1;
  times.forEach((time, index) => {
    while (at + 1 < x.times.length && (x.times[at + 1] as number) < time) at += 1;
    // One sample of the other curve for each of this one: bursts have several of one time.
    if (x.times[at + 1] === time) at += 1;
    if (at >= 0) xs[index] = x.values[at] as number;
  });
  return { xs, ys: values };
}
