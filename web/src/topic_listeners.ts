/** The listeners of one topic in this page, each with its own throttle rate. */
import type { Message } from "./hub";

/** The connection header of a message's publisher, for subscriptions that ask for it. */
export type Header = Readonly<Record<string, string>>;

export type MessageListener = (message: Message, header: Header) => void;

type Delivery = Parameters<MessageListener>;

interface Listener<Operation> {
  readonly operation: Operation;
  readonly throttle: number;
  readonly listener: MessageListener;
  /** When it last received a message, in ms; -Infinity before the first. */
  lastTime: number;
  /** The newest message that is delayed by its throttle rate. */
  pending: Delivery | undefined;
  timer: number | undefined;
}

export class TopicListeners<Operation = never> {
  readonly #listeners = new Map<string, Listener<Operation>>();
  #newest: Message | undefined;

  get isEmpty(): boolean {
    return this.#listeners.size === 0;
  }

  /** The operations that subscribed, to be sent again on a new connection. */
  operations(): Operation[] {
    return Array.from(this.#listeners.values(), ({ operation }) => operation);
  }

  /** `throttle` is the minimum time between two messages, in ms. */
  add(id: string, operation: Operation, throttle: number, listener: MessageListener): void {
    const state = { lastTime: -Infinity, pending: undefined, timer: undefined };
    this.#listeners.set(id, { operation, throttle, listener, ...state });
  }

  /** Returns whether the listener existed. */
  remove(id: string): boolean {
    clearTimeout(this.#listeners.get(id)?.timer);
    return this.#listeners.delete(id);
  }

  dispatch(message: Message, header: Header = {}): void {
    const all = [...this.#listeners.values()];
    const added = all.filter(({ lastTime }) => lastTime === -Infinity);
    // The hub sends a latched message again for each new subscription: only that one gets it.
    const isRepeated = added.length > 0 && added.length < all.length && this.#isNewest(message);
    this.#newest = message;
    const shortest = Math.min(...all.map(({ throttle }) => throttle));
    for (const each of isRepeated ? added : all) {
      // The hub throttles to the shortest time; throttling to that again would skip messages.
      const wait = each.lastTime + each.throttle - performance.now();
      if (each.throttle <= shortest || wait <= 0) this.#deliver(each, message, header);
      else this.#delay(each, [message, header], wait);
    }
  }

  #isNewest(message: Message): boolean {
    return JSON.stringify(message) === JSON.stringify(this.#newest);
  }

  #delay(to: Listener<Operation>, delivery: Delivery, wait: number): void {
    to.pending = delivery;
    to.timer ??= setTimeout(() => {
      to.timer = undefined;
      if (to.pending !== undefined) this.#deliver(to, ...to.pending);
    }, wait) as unknown as number;
  }

  #deliver(to: Listener<Operation>, ...delivery: Delivery): void {
    to.lastTime = performance.now();
    to.pending = undefined;
    clearTimeout(to.timer);
    to.timer = undefined;
    to.listener(...delivery);
  }
}
