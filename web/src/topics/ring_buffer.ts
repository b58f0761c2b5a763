/** A ring buffer for the newest samples of one number. */

/** Times in seconds and values, of the same length. */
export interface Samples {
  readonly times: Float64Array;
  readonly values: Float64Array;
}

export class RingBuffer {
  readonly #times: Float64Array;
  readonly #values: Float64Array;
  readonly #capacity: number;
  /** How many samples were added. Those before the newest `capacity` are overwritten. */
  #count = 0;

  constructor(capacity: number) {
    this.#capacity = capacity;
    this.#times = new Float64Array(capacity);
    this.#values = new Float64Array(capacity);
  }

  get length(): number {
    return Math.min(this.#count, this.#capacity);
  }

  get first(): number | undefined {
    return this.length === 0 ? undefined : this.#time(this.#count - this.length);
  }

  get newest(): number | undefined {
    return this.length === 0 ? undefined : this.#value(this.#count - 1);
  }

  /** Add a sample. Times never decrease: an earlier one is replaced by that of the last sample. */
  push(time: number, value: number): void {
    const last = this.#count === 0 ? -Infinity : this.#time(this.#count - 1);
    const at = this.#count % this.#capacity;
    this.#times[at] = Math.max(time, last);
    this.#values[at] = value;
    this.#count += 1;
  }

  clear(): void {
    this.#count = 0;
  }

  /** All samples. */
  all(): Samples {
    return this.slice(0, this.#count);
  }

  /** The newest value at a time. */
  valueAt(time: number): number | undefined {
    const after = this.after(time);
    return after === this.#count - this.length ? undefined : this.#value(after - 1);
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
    let low = this.#count - this.length;
    let high = this.#count;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.#time(middle) <= time) low = middle + 1;
      else high = middle;
    }
    return low;
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
   * Keep the minimum and the maximum of every `size` samples.
   *
   * Counted from the first sample ever, so that the curve does not flicker as it moves.
   */
  #thin(start: number, end: number, size: number): Samples {
    const chosen: number[] = [];
    for (let next = start; next < end; ) {
      const stop = Math.min(end, (Math.floor(next / size) + 1) * size);
      let least = next;
      let greatest = next;
      for (let at = next; at < stop; at += 1) {
        if (this.#value(at) < this.#value(least)) least = at;
        if (this.#value(at) > this.#value(greatest)) greatest = at;
      }
      chosen.push(Math.min(least, greatest));
      if (least !== greatest) chosen.push(Math.max(least, greatest));
      next = stop;
    }
    return {
      times: Float64Array.from(chosen, (at) => this.#time(at)),
      values: Float64Array.from(chosen, (at) => this.#value(at)),
    };
  }

  #time(at: number): number {
    return this.#times[at % this.#capacity] ?? NaN;
  }

  #value(at: number): number {
    return this.#values[at % this.#capacity] ?? NaN;
  }
}
