/** The messages of the last minutes, in memory. */
import { isStatic, type Kept, type Store, type Wish } from "./store";

/** Bytes of a message beside its own, by and large. */
const OVERHEAD = 200;
/** Removed messages that an array may begin with before it is cut. */
const MAX_REMOVED = 1000;

/** The messages of one topic; places are counted from the first one ever kept. */
class Track {
  readonly isStatic: boolean;
  #messages: (Kept | undefined)[] = [];
  /** The place of the first element, and of the first message. */
  #base = 0;
  first = 0;

  constructor(topic: string) {
    this.isStatic = isStatic(topic);
  }

  get end(): number {
    return this.#base + this.#messages.length;
  }

  at(place: number): Kept | undefined {
    return place < this.first ? undefined : this.#messages[place - this.#base];
  }

  push(kept: Kept): void {
    this.#messages.push(kept);
  }

  /** Remove the first message. */
  shift(): Kept | undefined {
    const kept = this.at(this.first);
    this.#messages[this.first - this.#base] = undefined;
    this.first += 1;
    if (this.first - this.#base > MAX_REMOVED) {
      this.#messages = this.#messages.slice(this.first - this.#base);
      this.#base = this.first;
    }
    return kept;
  }

  /** The time from which on another message counts in place of the first. */
  get superseded(): number {
    return this.isStatic ? Infinity : (this.at(this.first + 1)?.time ?? Infinity);
  }

  /** The place of the first message that is later than a time. */
  placeAfter(time: number): number {
    let low = this.first;
    let high = this.end;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if ((this.at(middle)?.time ?? Infinity) > time) high = middle;
      else low = middle + 1;
    }
    return low;
  }
}

/**
 * Messages in the order in which they came, up to a number of bytes.
 *
 * Of more, those go that were replaced by a later one of their topic first. So the newest message of
 * each topic stays, such as a latched map, and all transforms that are static.
 */
export class History implements Store {
  readonly #limit: number;
  readonly #tracks = new Map<string, Track>();
  #start: number | undefined;
  #end = 0;
  #bytes = 0;

  /** `limit` is in bytes. */
  constructor(limit: number) {
    this.#limit = limit;
  }

  get start(): number {
    return this.#start ?? this.#end;
  }

  get end(): number {
    return this.#end;
  }

  get bytes(): number {
    return this.#bytes;
  }

  add(message: Kept): void {
    // Clocks may be set back; the order stays that of arrival.
    const time = Math.max(message.time, this.#end);
    const kept = time === message.time ? message : { ...message, time };
    this.#end = time;
    this.#start ??= time;
    let track = this.#tracks.get(kept.topic);
    if (track === undefined) {
      track = new Track(kept.topic);
      this.#tracks.set(kept.topic, track);
    }
    track.push(kept);
    this.#bytes += kept.size + OVERHEAD;
    while (this.#bytes > this.#limit && this.#removeOldest());
  }

  /** Remove the message that was replaced first; return whether there is one. */
  #removeOldest(): boolean {
    let oldest: Track | undefined;
    for (const track of this.#tracks.values())
      if (track.superseded < (oldest?.superseded ?? Infinity)) oldest = track;
    if (oldest === undefined) return false;
    this.#start = Math.max(this.start, oldest.superseded);
    this.#bytes -= (oldest.shift()?.size ?? 0) + OVERHEAD;
    return true;
  }

  async before(wanted: ReadonlyMap<string, Wish>, time: number): Promise<Kept[]> {
    const found: Kept[] = [];
    for (const [topic, { count, span }] of wanted) {
      const track = this.#tracks.get(topic);
      if (track === undefined) continue;
      const end = track.placeAfter(time);
      const wished = Math.min(end - count, track.placeAfter(time - span));
      const first = track.isStatic ? track.first : Math.max(track.first, wished);
      for (let place = first; place < end; place += 1) {
        const kept = track.at(place);
        if (kept !== undefined) found.push(kept);
      }
    }
    return found.sort((a, b) => a.time - b.time);
  }

  async *after(topics: ReadonlySet<string>, time: number): AsyncGenerator<Kept> {
    const places = new Map<string, number>();
    for (;;) {
      let next: Kept | undefined;
      for (const topic of topics) {
        const track = this.#tracks.get(topic);
        if (track === undefined) continue;
        const place = Math.max(places.get(topic) ?? track.placeAfter(time), track.first);
        places.set(topic, place);
        const kept = track.at(place);
        if (kept !== undefined && (next === undefined || kept.time < next.time)) next = kept;
      }
      if (next === undefined) return;
      places.set(next.topic, (places.get(next.topic) ?? 0) + 1);
      yield next;
    }
  }
}
