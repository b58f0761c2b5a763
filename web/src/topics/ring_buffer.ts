/** A ring buffer for the newest samples of one number. */

/** Times in seconds and values, of the same length. */
export interface Samples {
  readonly times: Float64Array;
  /** NaN is a gap, or the number NaN. */
  readonly values: Float64Array;
}

/** What a message had. */
export interface Sample {
  readonly time: number;
  /** Exactly as it was sent; `undefined` is a gap. */
  readonly value: number | bigint | undefined;
}

/** Samples for which there is room at first; it doubles up to the capacity. */
const FIRST_ROOM = 1024;

/** The NaN of a gap is told from one that was sent by its place in another array. */
export const GAP = Number.NaN;

/**
 * A number as a value that is drawn and what is to be added to that: an integer of 64 bits may lose
 * digits. Whether it is such an integer is known by a rest of -0, which no difference is.
 */
export function exactParts(value: number | bigint): [value: number, rest: number] {
  const rounded = Number(value);
  if (typeof value === "number") return [rounded, 0];
  const rest = Number(value - BigInt(rounded));
  return [rounded, rest === 0 ? -0 : rest];
}

export class RingBuffer {
  #times: Float64Array;
  #values: Float64Array;
  /** What `exactParts` says of each value; NaN in gaps. */
  #rests: Float64Array | undefined;
  #room: number;
  readonly #capacity: number;
  /** How many samples were added. Those before the newest `capacity` are overwritten. */
  #count = 0;

  constructor(capacity: number) {
    this.#capacity = capacity;
    this.#room = Math.min(capacity, FIRST_ROOM);
    this.#times = new Float64Array(this.#room);
    this.#values = new Float64Array(this.#room);
  }

  get length(): number {
    return Math.min(this.#count, this.#capacity);
  }

  get first(): number | undefined {
    return this.length === 0 ? undefined : this.#time(this.#count - this.length);
  }

  /** The newest value as it was sent. */
  get newest(): number | bigint | undefined {
    return this.length === 0 ? undefined : this.#exact(this.#count - 1);
  }

  /** Add a sample, and its rest. Times never decrease: an earlier one is replaced by that of the last. */
  add(time: number, value: number, rest = 0): void {
    const last = this.#count === 0 ? -Infinity : this.#time(this.#count - 1);
    if (this.#count === this.#room && this.#room < this.#capacity) this.#grow();
    const at = this.#count % this.#room;
    this.#times[at] = Math.max(time, last);
    this.#values[at] = value;
    if (!Object.is(rest, 0)) this.#rests ??= new Float64Array(this.#room);
    if (this.#rests !== undefined) this.#rests[at] = rest;
    this.#count += 1;
  }

  /** Add a number as it was sent. */
  push(time: number, value: number | bigint): void {
    this.add(time, ...exactParts(value));
  }

  /** Add a gap: there was no number, or no subscription. */
  pushGap(time: number): void {
    this.add(time, GAP, GAP);
  }

  clear(): void {
    this.#count = 0;
  }

  /** All samples, or those between two times, as they were sent. */
  *all(from = -Infinity, to = Infinity): Generator<Sample> {
    for (let at = this.#before(from); at < this.#count; at += 1) {
      if (this.#time(at) > to) return;
      yield { time: this.#time(at), value: this.#exact(at) };
    }
  }

  /** The least and the greatest finite value between two times. */
  extent(from: number, to: number): readonly [least: number, greatest: number] {
    let [least, greatest] = [Infinity, -Infinity];
    const end = this.after(to);
    for (let at = this.#before(from); at < end; at += 1) {
      const value = this.#value(at);
      if (!Number.isFinite(value)) continue;
      if (value < least) least = value;
      if (value > greatest) greatest = value;
    }
    return [least, greatest];
  }

  /** The samples between two times, without any others. */
  within(from: number, to: number): Samples {
    const start = this.#before(from);
    return this.#copy(start, Math.max(0, this.after(to) - start));
  }

  /** The newest value at a time, as it was sent. */
  valueAt(time: number): number | bigint | undefined {
    const after = this.after(time);
    return after === this.#count - this.length ? undefined : this.#exact(after - 1);
  }

  /**
   * The samples between two times, with the last before and the first after them.
   *
   * More than `limit` samples are thinned out to about that many, keeping all peaks.
   */
  between(from: number, to: number, limit: number): Samples {
    const start = Math.max(this.#count - this.length, this.after(from) - 1);
    const end = Math.min(this.#count, this.after(to) + 1);
    const count = end - start;
    if (count <= limit) return this.#copy(start, count);
    return this.#thin(start, end, 2 ** Math.ceil(Math.log2((2 * count) / limit)));
  }

  /** The samples from an index up to another one, which is not included. */
  slice(start: number, end: number): Samples {
    const first = Math.max(start, this.#count - this.length);
    return this.#copy(first, Math.max(0, end - first));
  }

  /** The index of the first sample after a time, counted from the first sample ever. */
  after(time: number): number {
    return this.#firstWhere((each) => each > time);
  }

  /** The index of the first sample that is not before a time. */
  #before(time: number): number {
    return this.#firstWhere((each) => each >= time);
  }

  #firstWhere(isPast: (time: number) => boolean): number {
    let low = this.#count - this.length;
    let high = this.#count;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (isPast(this.#time(middle))) high = middle;
      else low = middle + 1;
    }
    return low;
  }

  #grow(): void {
    this.#room = Math.min(this.#capacity, 2 * this.#room);
    const larger = (old: Float64Array): Float64Array => {
      const array = new Float64Array(this.#room);
      array.set(old);
      return array;
    };
    this.#times = larger(this.#times);
    this.#values = larger(this.#values);
    if (this.#rests !== undefined) this.#rests = larger(this.#rests);
  }

  #exact(at: number): number | bigint | undefined {
    const value = this.#value(at);
    const rest = this.#rests?.[at % this.#room] ?? 0;
    if (Number.isNaN(rest)) return undefined;
    return Object.is(rest, 0) ? value : BigInt(value) + BigInt(rest);
  }

  #copy(start: number, count: number): Samples {
    const times = new Float64Array(count);
    const values = new Float64Array(count);
    for (let at = 0; at < count; at += 1) {
      times[at] = this.#time(start + at);
      values[at] = this.#value(start + at);
    }
    return { times, values };
  }

  /**
   * Keep the minimum and the maximum of every `size` samples, and whether there is a gap.
   *
   * Counted from the first sample ever, so that the curve does not flicker as it moves. A number that
   * cannot be drawn, such as infinity, hides no peak beside it.
   */
  #thin(start: number, end: number, size: number): Samples {
    const chosen: number[] = [];
    for (let next = start; next < end; ) {
      const stop = Math.min(end, (Math.floor(next / size) + 1) * size);
      for (const at of this.#peaks(next, stop)) chosen.push(at);
      next = stop;
    }
    return {
      times: Float64Array.from(chosen, (at) => this.#time(at)),
      values: Float64Array.from(chosen, (at) => this.#value(at)),
    };
  }

  /** The places of the least, of the greatest, and of one that is not finite, in their order. */
  #peaks(start: number, end: number): number[] {
    let least = -1;
    let greatest = -1;
    let other = -1;
    for (let at = start; at < end; at += 1) {
      const value = this.#value(at);
      if (!Number.isFinite(value)) other = at;
      else {
        if (least < 0 || value < this.#value(least)) least = at;
        if (greatest < 0 || value > this.#value(greatest)) greatest = at;
      }
    }
    const found = new Set([least, greatest, other].filter((at) => at >= 0));
    return [...found].sort((one, another) => one - another);
  }

  #time(at: number): number {
    return this.#times[at % this.#room] ?? NaN;
  }

  #value(at: number): number {
    return this.#values[at % this.#room] ?? NaN;
  }
}
