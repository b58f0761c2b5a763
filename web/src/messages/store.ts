/** Messages that can be shown again: those of the last minutes, or of a file. */
import type { Fields } from "./reader";

/** A message, serialized. */
export interface Kept {
  readonly topic: string;
  readonly type: string;
  /** When it was received or recorded, in ms since 1970. */
  readonly time: number;
  /** Bytes in memory. */
  readonly size: number;
  /** The node that published it; empty if that is not known. */
  readonly node: string;
  /** Read it: each call makes another message, which shares no memory with others. */
  read(): Fields;
}

/** How much of a topic is wanted at a moment: so many messages, and all of so long before it, in ms. */
export interface Wish {
  readonly count: number;
  readonly span: number;
}

/** All times are in ms since 1970. */
export interface Store {
  /** Everything from here on can be shown. */
  readonly start: number;
  readonly end: number;
  /** Bytes in memory. */
  readonly bytes: number;
  /** The last messages of topics up to a time, in order: of each topic as much as is wanted. */
  before(wanted: ReadonlyMap<string, Wish>, time: number): Promise<Kept[]>;
  /** All messages of topics that are later than a time, in order. */
  after(topics: ReadonlySet<string>, time: number): AsyncIterable<Kept>;
}

/** Whether all messages of a topic count at any time, and not only the newest. */
export function isStatic(topic: string): boolean {
  return topic.endsWith("/tf_static");
}
