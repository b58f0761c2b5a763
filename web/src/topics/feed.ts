/** One topic's messages, taken apart into the numbers that are plotted. */
import type { Hub, Message } from "../hub";
import { numberAt, own, stepsOf } from "../types";
import { Ring } from "./ring";

const CAPACITY = 12_000;
/** Seconds that a header's time may be away from now and still be the time of the sample. */
const NEAR = 5;

export interface Curve {
  readonly path: string;
  readonly ring: Ring;
}

export class Feed {
  readonly topic: string;
  /** Why the hub does not give it; empty if it does. */
  refusal = "";
  /** The path at which the newest message had no number; empty if all had. */
  odd = "";
  readonly #hub: Hub;
  readonly #came: () => void;
  readonly #curves = new Map<Curve, readonly (string | number)[]>();
  #throttle: number;
  #end: (() => void) | undefined;
  #newest: { readonly message: Message; readonly time: number } | undefined;

  /** `throttle` is the least time between two messages, in ms; `came` is called with each. */
  constructor(hub: Hub, topic: string, throttle: number, came: () => void) {
    this.#hub = hub;
    this.topic = topic;
    this.#throttle = throttle;
    this.#came = came;
  }

  set throttle(throttle: number) {
    if (throttle === this.#throttle) return;
    this.#throttle = throttle;
    if (this.#end === undefined) return;
    this.#leave();
    this.start();
  }

  add(path: string): Curve {
    const curve = { path, ring: new Ring(CAPACITY) };
    this.#curves.set(curve, stepsOf(path) ?? []);
    // A topic that seldom speaks has a value at once.
    if (this.#newest !== undefined) this.#take(curve, this.#newest.message, this.#newest.time);
    return curve;
  }

  /** Tells whether this was the last, so that the feed has ended. */
  remove(curve: Curve): boolean {
    this.#curves.delete(curve);
    if (this.#curves.size > 0) return false;
    this.stop();
    return true;
  }

  start(): void {
    this.#end ??= this.#hub.subscribe(
      this.topic,
      { throttle: this.#throttle, queue: 1 },
      (message) => this.#hear(message),
      (why) => {
        this.refusal = why;
        this.#came();
      },
    );
  }

  stop(): void {
    if (this.#end === undefined) return;
    this.#leave();
    // What was missed is a gap in the curve.
    for (const { ring } of this.#curves.keys())
      if (ring.length > 0) ring.push(Date.now() / 1000, NaN);
  }

  #leave(): void {
    this.#end?.();
    this.#end = undefined;
  }

  #hear(message: Message): void {
    this.refusal = "";
    this.odd = "";
    const time = timeOf(message, Date.now() / 1000);
    this.#newest = { message, time };
    for (const curve of this.#curves.keys()) this.#take(curve, message, time);
    this.#came();
  }

  #take(curve: Curve, message: Message, time: number): void {
    const value = numberAt(message, this.#curves.get(curve) ?? []);
    if (value === undefined) this.odd = curve.path;
    curve.ring.push(time, value ?? NaN);
  }
}

/** When a message was made, if its header says so and is about right; else when it came. */
export function timeOf(message: Message, now: number): number {
  const stamp = numberAt(own(message, "header"), ["stamp"]);
  return stamp !== undefined && Math.abs(stamp - now) <= NEAR ? stamp : now;
}
