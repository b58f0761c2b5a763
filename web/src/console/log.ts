/** The messages that nodes log on `/rosout` while the page is open. */
import type { Filter } from "../filter";
import { timeOfDay } from "../format";
import type { Message } from "../hub";
import { subscribe } from "../messages/data_client";
import { type Signal, Source } from "../signal";
import type { DataSource } from "../source";

/** One logged message. */
export interface Entry {
  /** Counted from 1, without gaps. */
  number: number;
  secs: number;
  nsecs: number;
  level: number;
  node: string;
  text: string;
  /** File, line and function; empty if they are not known. */
  where: string;
}

export interface Level {
  value: number;
  /** As in ROS. */
  name: string;
}

/** The levels of rosgraph_msgs/Log, in ascending order. */
export const LEVELS: readonly Level[] = [
  { value: 1, name: "DEBUG" },
  { value: 2, name: "INFO" },
  { value: 4, name: "WARN" },
  { value: 8, name: "ERROR" },
  { value: 16, name: "FATAL" },
];

/** The name of a level; unknown ones get their number. */
export function levelName(value: number): string {
  return LEVELS.find((level) => level.value === value)?.name ?? `LEVEL ${value}`;
}

/** Which entries are shown. */
export interface EntryFilter {
  /** The minimum level. */
  level: number;
  /** A node's full name; empty for all nodes. */
  node: string;
  text: Filter;
}

export function passes(entry: Entry, { level, node, text }: EntryFilter): boolean {
  if (entry.level < level || (node !== "" && entry.node !== node)) return false;
  return text.shows([entry.node, entry.text]);
}

/** An entry as rospy prints it: `[INFO] [1700000000.123456] [/talker]: hello`. */
export function line(entry: Entry): string {
  const micros = String(Math.floor(entry.nsecs / 1000)).padStart(6, "0");
  return `[${levelName(entry.level)}] [${entry.secs}.${micros}] [${entry.node}]: ${entry.text}`;
}

/** The local time of day to the millisecond. */
export function clock({ secs, nsecs }: Pick<Entry, "secs" | "nsecs">): string {
  return `${timeOfDay(secs)}.${String(Math.floor(nsecs / 1e6)).padStart(3, "0")}`;
}

/** How many entries are kept. */
export const MAX_ENTRIES = 2000;
/** How many messages the hub queues while the page falls behind. */
const QUEUE = 200;
/** The level of warnings. */
export const WARN = 4;

export class Log {
  /** The number of the newest entry; set at most once per frame. */
  readonly newest: Signal<number>;
  /** Whether the hub has subscribed, or refused that. */
  readonly isSettled: Signal<boolean>;
  /** Warnings and errors since the console was last visible. */
  readonly unseen: Signal<number>;

  /** How often the log was cleared. */
  readonly cleared: Signal<number>;

  readonly #hub: DataSource;
  readonly #newest = new Source(0);
  readonly #cleared = new Source(0);
  readonly #unseen = new Source(0);
  readonly #isSettled = new Source(false);
  #entries: Entry[] = [];
  #count = 0;
  #warnings = 0;
  #visible = false;
  #frame: number | undefined;

  constructor(hub: DataSource) {
    this.#hub = hub;
    this.newest = this.#newest;
    this.cleared = this.#cleared;
    hub.clock.onJump(() => this.clear());
    this.unseen = this.#unseen;
    this.isSettled = this.#isSettled;
    subscribe(
      hub,
      { topic: "/rosout_agg", queue: QUEUE },
      (message) => this.add(message),
      // An empty text says that the connection is back.
      (why) => this.#isSettled.set(why !== "" && hub.state.value === "open"),
      () => this.#isSettled.set(true),
    );
  }

  /** The entries after a number, oldest first. */
  after(number: number): Entry[] {
    const missing = Math.min(this.#count - number, this.#entries.length);
    return missing > 0 ? this.#entries.slice(-missing) : [];
  }

  /** Record whether the console is visible: then no entry counts as unseen. */
  setVisible(visible: boolean): void {
    this.#visible = visible;
    this.#warnings = 0;
    this.#unseen.set(0);
  }

  clear(): void {
    this.#entries = [];
    this.#cleared.set(this.#cleared.value + 1);
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
    if (this.#entries.length > MAX_ENTRIES) this.#entries.shift();
    const isUnseen = !this.#visible && this.#hub.clock.playback.value.isLive;
    if (entry.level >= WARN && isUnseen) this.#warnings += 1;
    // A hidden page has no frames, and nothing to draw.
    this.#frame ??= requestAnimationFrame(() => {
      this.#frame = undefined;
      this.#unseen.set(this.#warnings);
      this.#newest.set(this.#count);
    });
  }
}

function where(message: Message): string {
  const [file, line, name] = [message.file, message.line, message.function];
  if (typeof file !== "string" || file === "") return "";
  return `${file}:${String(line)}${typeof name === "string" && name !== "" ? ` ${name}` : ""}`;
}
