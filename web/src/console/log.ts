/** The newest of what all nodes have said on `/rosout`, from the page's opening. */
import type { Hub, Message } from "../hub";
import { type Signal, Source } from "../signal";
import type { Entry } from "./entry";

/** Entries that are kept. */
export const ROOM = 2000;
/** Messages that the hub keeps for a page that falls behind. */
const QUEUE = 200;
/** The level of warnings: from here on something is wrong. */
export const GRAVE = 4;

export class Log {
  /** The number of the newest entry; told at most once per frame. */
  readonly newest: Signal<number>;
  /** Warnings and errors since somebody looked. */
  readonly unseen: Signal<number>;

  readonly #newest = new Source(0);
  readonly #unseen = new Source(0);
  #entries: Entry[] = [];
  #count = 0;
  #wrong = 0;
  #looking = false;
  #frame: number | undefined;

  constructor(hub: Hub) {
    this.newest = this.#newest;
    this.unseen = this.#unseen;
    hub.subscribe("/rosout_agg", { queue: QUEUE }, (message) => {
      this.add(message);
    });
  }

  /** The entries that came after one, the oldest first. */
  after(number: number): Entry[] {
    const missing = Math.min(this.#count - number, this.#entries.length);
    return missing > 0 ? this.#entries.slice(-missing) : [];
  }

  /** While somebody looks, nothing counts as unseen. */
  look(looking: boolean): void {
    this.#looking = looking;
    this.#wrong = 0;
    this.#unseen.set(0);
  }

  clear(): void {
    this.#entries = [];
  }

  add(message: Message): void {
    this.#count += 1;
    const { secs = 0, nsecs = 0 } =
      (message.header as { stamp?: { secs?: number; nsecs?: number } } | undefined)?.stamp ?? {};
    const entry: Entry = {
      number: this.#count,
      secs,
      nsecs,
      level: Number(message.level),
      node: String(message.name),
      text: String(message.msg),
      where: where(message),
    };
    this.#entries.push(entry);
    if (this.#entries.length > ROOM) this.#entries.shift();
    if (entry.level >= GRAVE && !this.#looking) this.#wrong += 1;
    // A page out of sight has no frames, and nothing to draw either.
    this.#frame ??= requestAnimationFrame(() => {
      this.#frame = undefined;
      this.#unseen.set(this.#wrong);
      this.#newest.set(this.#count);
    });
  }
}

function where(message: Message): string {
  const [file, line, name] = [message.file, message.line, message.function];
  if (typeof file !== "string" || file === "") return "";
  return `${file}:${String(line)}${typeof name === "string" && name !== "" ? ` ${name}` : ""}`;
}
