/** A recording that is read in parts: its topics, and the messages of any moment. */
import { readDefinition } from "../messages/definition";
import { type Fields, makeReader, type Reader } from "../messages/reader";
import type { Topic } from "../messages/recording_messages";
import { isStatic, type Kept, type Store, type Wish } from "../messages/store";
import { type CountedRanges, Unreachable } from "./ranges";

export interface Recording extends Store {
  readonly topics: readonly Topic[];
  /** What is wrong with the file. */
  readonly warnings: readonly string[];
}

/** Those who want all messages get those of so long before a moment, in ms. */
const BEFORE = 30_000;
/** Bytes that are read for that at most, of each topic: images beside it may be many. */
const MAX_READ = 64 * 2 ** 20;
/** Topics that are read together before a moment, in ms; each of the others is read by itself. */
const TOGETHER = 1000;
/** Most messages before a moment, for the memory; more of those who say how long before it they want. */
const MAX_BEFORE = 20_000;
const MAX_IN_SPAN = 200_000;
/** More than times may lose by being rounded to ms, in ms. */
const ROUNDED = 0.001;

const NOTHING: Wish = { count: 0, span: 0 };

/** What reads the messages of one channel of a file. */
export class Channel {
  readonly topic: Topic;
  readonly #read: (bytes: Uint8Array) => Fields;

  /** `encoding` is that of messages, as MCAP names it: `ros1`, `cdr` or `json`. */
  constructor(name: string, type: string, definition: string, encoding: string) {
    this.topic = { name, type: type.replace("/msg/", "/"), definition };
    this.#read = readerOf(this.topic, encoding);
  }

  kept(time: number, bytes: Uint8Array, node = ""): Kept {
    const { name, type } = this.topic;
    // Readers share the memory that they are given.
    const read = (): Fields => this.#read(bytes.slice());
    return { topic: name, type, time, size: bytes.length, node, read };
  }
}

function readerOf({ name, type, definition }: Topic, encoding: string): Reader {
  if (encoding === "json") return (bytes) => JSON.parse(new TextDecoder().decode(bytes)) as Fields;
  const isCdr = encoding === "cdr";
  if (!isCdr && encoding !== "ros1")
    return () => {
      throw new Error(`messages of ${name} are serialized as ${encoding}, which cannot be shown`);
    };
  let reader: Reader | undefined;
  return (bytes) => {
    reader ??= makeReader(readDefinition(type, definition), isCdr);
    return reader(bytes);
  };
}

/** The topics of channels, by their names. */
export function topicsOf(channels: Iterable<Channel>): Topic[] {
  const topics = new Map([...channels].map(({ topic }) => [topic.name, topic]));
  return [...topics.values()].sort((a, b) => a.name.localeCompare(b.name));
}

/** A recording with an index. */
export abstract class IndexedRecording implements Recording {
  abstract readonly topics: readonly Topic[];
  abstract readonly start: number;
  abstract readonly end: number;
  readonly bytes = 0;
  readonly warnings: string[] = [];
  readonly #warn: () => void;

  readonly #ranges: Pick<CountedRanges, "total">;

  /** `ranges` is the file; `warn` is called when there is another warning. */
  constructor(ranges: Pick<CountedRanges, "total">, warn: () => void) {
    this.#ranges = ranges;
    this.#warn = warn;
  }

  /** The messages of topics from one time to another, or back from that; all of it inclusive. */
  protected abstract read(
    topics: readonly string[],
    from: number,
    to: number,
    isBack: boolean,
  ): AsyncIterable<Kept>;

  /** Leave out the damaged part at a time. Returns whether there was another part to leave out. */
  protected abstract leaveOut(topics: readonly string[], time: number, isBack: boolean): boolean;

  async before(wanted: ReadonlyMap<string, Wish>, time: number): Promise<Kept[]> {
    const found = new Map([...wanted.keys()].map((topic): [string, Kept[]] => [topic, []]));
    const isFull = (topic: string): boolean => {
      const { count, span } = wanted.get(topic) ?? NOTHING;
      const most = span > 0 ? MAX_IN_SPAN : Math.min(count, MAX_BEFORE);
      return (found.get(topic)?.length ?? 0) >= most;
    };
    /** Take messages of topics between two times, the newest first, until there are enough. */
    const take = async (topics: readonly string[], from: number, to: number, isEnough = isFull) => {
      for await (const kept of this.#readOn(topics, from, to, true)) {
        if (kept.time < from || isFull(kept.topic)) continue;
        // What ends at this time was taken before.
        if (to === time || kept.time < to) found.get(kept.topic)?.push(kept);
        if (topics.every(isEnough)) return;
      }
    };
    const isKnown = (topic: string): boolean => (found.get(topic)?.length ?? 0) > 0;
    const others = [...wanted.keys()].filter((topic) => !isStatic(topic));
    await take(others, time - TOGETHER, time);
    const earlier = time - TOGETHER;
    for (const topic of others) {
      const { count, span } = wanted.get(topic) ?? NOTHING;
      if (count > 1 && !isFull(topic)) {
        const most = this.#ranges.total + MAX_READ;
        const isEnough = (): boolean => isFull(topic) || this.#ranges.total > most;
        await take([topic], time - Math.max(BEFORE, span), earlier, isEnough);
      }
      if (!isKnown(topic)) await take([topic], this.start, earlier, isKnown);
    }
    for (const topic of wanted.keys()) {
      if (!isStatic(topic)) continue;
      for await (const kept of this.#readOn([topic], this.start, time, false))
        found.get(topic)?.push(kept);
    }
    return [...found.values()].flat().sort((a, b) => a.time - b.time);
  }

  async *after(topics: ReadonlySet<string>, time: number): AsyncGenerator<Kept> {
    for await (const kept of this.#readOn([...topics], time, this.end, false))
      if (kept.time > time) yield kept;
  }

  /** Read, and leave out what is damaged. */
  async *#readOn(
    topics: readonly string[],
    from: number,
    to: number,
    isBack: boolean,
  ): AsyncGenerator<Kept> {
    let at = isBack ? to : from;
    const known = this.topics.map(({ name }) => name);
    const present = topics.filter((topic) => known.includes(topic));
    if (present.length === 0 || from > to) return;
    /** How many messages of this time have been read. */
    let count = 0;
    for (;;) {
      let again = count;
      try {
        const range = isBack ? ([from, at] as const) : ([at, to] as const);
        for await (const kept of this.read(present, range[0], range[1], isBack)) {
          // After damage, those of the same time come again.
          if (kept.time === at && again > 0) {
            again -= 1;
            continue;
          }
          count = kept.time === at ? count + 1 : 1;
          at = kept.time;
          if (kept.time >= from - ROUNDED && kept.time <= to) yield kept;
        }
        return;
      } catch (error) {
        if (error instanceof Unreachable) {
          this.warn(`a part of the file was not received: ${error.message}`);
          return;
        }
        this.warn(`a part of the file is left out: ${(error as Error).message}`);
        if (!this.leaveOut(present, at, isBack)) return;
      }
    }
  }

  protected warn(text: string): void {
    if (this.warnings.includes(text)) return;
    this.warnings.push(text);
    this.#warn();
  }
}
