/** Several files as one recording, such as the parts of a folder of rosbag2. */
import type { Topic } from "../messages/recording_messages";
import { isStatic, type Kept, type Wish } from "../messages/store";
import type { Recording } from "./recording";

export class JoinedRecording implements Recording {
  readonly topics: readonly Topic[];
  readonly start: number;
  readonly end: number;
  /** In the order of their starts. */
  readonly #parts: readonly Recording[];
  readonly #warnings: readonly string[];

  /** `warnings` are about the files together. There is at least one part. */
  constructor(parts: readonly Recording[], warnings: readonly string[]) {
    this.#parts = parts.toSorted((a, b) => a.start - b.start);
    this.#warnings = warnings;
    const topics = this.#parts.flatMap((part) => part.topics);
    const byName = new Map(topics.map((topic) => [topic.name, topic]));
    this.topics = [...byName.values()].sort((a, b) => a.name.localeCompare(b.name));
    this.start = this.#parts[0]?.start ?? 0;
    this.end = this.#parts.reduce((most, { end }) => Math.max(most, end), this.start);
  }

  get bytes(): number {
    return this.#parts.reduce((sum, { bytes }) => sum + bytes, 0);
  }

  get warnings(): readonly string[] {
    return [...this.#warnings, ...new Set(this.#parts.flatMap(({ warnings }) => warnings))];
  }

  async before(wanted: ReadonlyMap<string, Wish>, time: number): Promise<Kept[]> {
    const found: Kept[] = [];
    const rest = new Map(wanted);
    for (const part of this.#parts.toReversed()) {
      if (part.start > time) continue;
      const earlier = await part.before(rest, time);
      for (const kept of earlier) found.push(kept);
      const known = new Set(earlier.map(({ topic }) => topic));
      for (const [topic, { count, span }] of rest) {
        // Some count as a whole, and some reach into the file before.
        const isWhole = count === 1 || part.start <= time - span;
        if (known.has(topic) && isWhole && !isStatic(topic)) rest.delete(topic);
      }
      if (rest.size === 0) break;
    }
    return found.sort((a, b) => a.time - b.time);
  }

  async *after(topics: ReadonlySet<string>, time: number): AsyncGenerator<Kept> {
    const later = this.#parts.filter(({ end }) => end > time);
    const open: { next: Kept; rest: AsyncIterator<Kept> }[] = [];
    const proceed = async (rest: AsyncIterator<Kept>): Promise<void> => {
      const { done, value } = await rest.next();
      if (done !== true) open.push({ next: value, rest });
    };
    for (;;) {
      let first = leastOf(open);
      // Parts may overlap.
      while (later[0] !== undefined && (first === undefined || later[0].start <= first.next.time)) {
        await proceed((later.shift() as Recording).after(topics, time)[Symbol.asyncIterator]());
        first = leastOf(open);
      }
      if (first === undefined) return;
      open.splice(open.indexOf(first), 1);
      yield first.next;
      await proceed(first.rest);
    }
  }
}

function leastOf<T extends { readonly next: Kept }>(all: readonly T[]): T | undefined {
  let least: T | undefined;
  for (const each of all) if (least === undefined || each.next.time < least.next.time) least = each;
  return least;
}

/** The files that a folder's metadata.yaml names. */
export function filesOf(metadata: string): string[] {
  const list = /^\s*relative_file_paths:\s*\n((?:\s*-.*\n?)*)/m.exec(metadata)?.[1] ?? "";
  return [...list.matchAll(/^\s*-\s*["']?([^"'\n]+?)["']?\s*$/gm)].map(([, name = ""]) => name);
}
