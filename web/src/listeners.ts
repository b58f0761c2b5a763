/** Those who listen to one topic in this page, each with its own rate. */
import type { Message } from "./hub";

interface Listener<Operation> {
  readonly operation: Operation;
  readonly throttle: number;
  readonly hear: (message: Message) => void;
  /** When it last heard one, in ms; -Infinity if it has not yet. */
  heard: number;
  /** The newest message that came too early for it. */
  kept: Message | undefined;
  timer: number | undefined;
}

export class Listeners<Operation = never> {
  readonly #listeners = new Map<string, Listener<Operation>>();
  #newest: Message | undefined;

  get empty(): boolean {
    return this.#listeners.size === 0;
  }

  /** The operations that subscribed them, to be said again to a new connection. */
  operations(): Operation[] {
    return Array.from(this.#listeners.values(), (listener) => listener.operation);
  }

  /** `throttle` is the least time between two messages, in ms. */
  add(id: string, operation: Operation, throttle: number, hear: (message: Message) => void): void {
    this.#listeners.set(id, {
      operation,
      throttle,
      hear,
      heard: -Infinity,
      kept: undefined,
      timer: undefined,
    });
  }

  /** Tells whether the listener was there. */
  remove(id: string): boolean {
    clearTimeout(this.#listeners.get(id)?.timer);
    return this.#listeners.delete(id);
  }

  tell(message: Message): void {
    const all = [...this.#listeners.values()];
    const newcomers = all.filter(({ heard }) => heard === -Infinity);
    // What is latched is told to each newcomer; the others have heard it.
    const again = newcomers.length > 0 && newcomers.length < all.length && this.#isNewest(message);
    this.#newest = message;
    const least = Math.min(...all.map(({ throttle }) => throttle));
    for (const listener of again ? newcomers : all) {
      // The hub itself keeps the shortest time; doing so again here would pass messages over.
      const wait = listener.heard + listener.throttle - performance.now();
      if (listener.throttle <= least || wait <= 0) this.#hand(listener, message);
      else this.#keep(listener, message, wait);
    }
  }

  #isNewest(message: Message): boolean {
    return JSON.stringify(message) === JSON.stringify(this.#newest);
  }

  #keep(listener: Listener<Operation>, message: Message, wait: number): void {
    listener.kept = message;
    listener.timer ??= setTimeout(() => {
      listener.timer = undefined;
      if (listener.kept !== undefined) this.#hand(listener, listener.kept);
    }, wait) as unknown as number;
  }

  #hand(listener: Listener<Operation>, message: Message): void {
    listener.heard = performance.now();
    listener.kept = undefined;
    clearTimeout(listener.timer);
    listener.timer = undefined;
    listener.hear(message);
  }
}
