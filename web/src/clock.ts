/** The time that the page shows: now, or a moment of what is kept or recorded. */
import { type Signal, Source } from "./signal";

/** What the worker reports of time. All times are in ms since 1970. */
export interface Playback {
  /** Whether messages are shown as they come. */
  readonly isLive: boolean;
  /** The moment that is shown, if not live. */
  readonly time: number;
  /** How many seconds pass in one; 0 while paused. */
  readonly speed: number;
  /** The times of the first and the last message that can be shown. */
  readonly start: number;
  readonly end: number;
  /** Bytes in memory. */
  readonly bytes: number;
  /** How the search for a message goes; empty if there is none, or it has found one. */
  readonly search?: "" | "searching" | "not found";
}

const LIVE: Playback = { isLive: true, time: 0, speed: 1, start: 0, end: 0, bytes: 0 };
/** How long time goes on without a report of the worker, in ms. */
const AHEAD = 500;

export class Clock {
  readonly playback: Signal<Playback>;
  readonly #playback = new Source(LIVE);
  readonly #listeners = new Set<() => void>();
  #reported = 0;

  constructor() {
    this.playback = this.#playback;
  }

  /** The shown time, in ms since 1970. */
  now(): number {
    const { isLive, time, speed } = this.#playback.value;
    if (isLive) return Date.now();
    return time + speed * Math.min(AHEAD, performance.now() - this.#reported);
  }

  /** Take a report of the worker. */
  report(playback: Playback): void {
    this.#reported = performance.now();
    this.#playback.set(playback);
  }

  /** Time jumps: what has been shown is not what was before the next message. */
  jump(): void {
    for (const listener of [...this.#listeners]) listener();
  }

  /** Call the listener when time jumps; returns a function that stops this. */
  onJump(listener: () => void): () => void {
    const own = (): void => listener();
    this.#listeners.add(own);
    return () => this.#listeners.delete(own);
  }
}
