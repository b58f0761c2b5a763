/** Subscribes to one topic and records the numbers that are plotted. */
import { resolve } from "../element_names";
import type { Hub, Message } from "../hub";
import { Stamps } from "../simulated_time";
import { numberAt, own, parsePath, pathText, type Step } from "../types";
import { RingBuffer } from "./ring_buffer";

const CAPACITY = 12_000;
/** A header's time is used if it differs from the clock by no more than this, in seconds. */
const MAX_SKEW = 5;

export class Curve {
  /** With the names of array elements once there was a message: `position[elbow]`. */
  path: string;
  readonly samples = new RingBuffer(CAPACITY);
  #steps: readonly Step[];

  constructor(path: string) {
    this.path = path;
    this.#steps = parsePath(path) ?? [];
  }

  /** Record the number of a message. Returns whether the message should have had one, but has not. */
  record(message: Message, time: number): boolean {
    const found = resolve(message, this.#steps);
    // Messages of other nodes have other elements: they leave no gap.
    if (found === undefined) return this.samples.length === 0;
    const value = numberAt(message, found.indices);
    this.samples.push(time, value ?? NaN);
    if (value === undefined) return true;
    // From now on the curve is that of the element with this name, wherever that is.
    this.#steps = found.named;
    this.path = pathText(found.named);
    return false;
  }
}

export class Sampler {
  readonly topic: string;
  /** Why the hub rejected the subscription; empty if it did not. */
  error = "";
  /** A path at which the newest message had no number; empty if there is none. */
  missing = "";
  readonly #hub: Hub;
  readonly #changed: () => void;
  readonly #curves = new Set<Curve>();
  readonly #stamps = new Stamps();
  #throttle: number;
  #unsubscribe: (() => void) | undefined;
  #newest: { readonly message: Message; readonly time: number } | undefined;

  /** `throttle` is the minimum time between two messages, in ms; `changed` is called for each. */
  constructor(hub: Hub, topic: string, throttle: number, changed: () => void) {
    this.#hub = hub;
    this.topic = topic;
    this.#throttle = throttle;
    this.#changed = changed;
  }

  set throttle(throttle: number) {
    if (throttle === this.#throttle) return;
    this.#throttle = throttle;
    if (this.#unsubscribe === undefined) return;
    this.#stopSubscription();
    this.start();
  }

  add(path: string): Curve {
    const curve = new Curve(path);
    this.#curves.add(curve);
    // So that a slow topic has a value at once.
    if (this.#newest !== undefined) this.#record(curve, this.#newest.message, this.#newest.time);
    return curve;
  }

  /** A path with the names of array elements, if there was a message. */
  named(path: string): string {
    const found = this.#newest && resolve(this.#newest.message, parsePath(path) ?? []);
    return found === undefined ? path : pathText(found.named);
  }

  /** Remove a curve. Returns whether it was the last: then the subscription has ended. */
  remove(curve: Curve): boolean {
    this.#curves.delete(curve);
    if (this.#curves.size > 0) return false;
    this.stop();
    return true;
  }

  start(): void {
    this.#unsubscribe ??= this.#hub.subscribe(
      this.topic,
      { throttle: this.#throttle, queue: 1 },
      (message) => this.#receive(message),
      (why) => {
        this.error = why;
        this.#changed();
      },
    );
  }

  stop(): void {
    if (this.#unsubscribe === undefined) return;
    this.#stopSubscription();
    // The time without a subscription is a gap in the curve.
    for (const { samples } of this.#curves)
      if (samples.length > 0) samples.push(Date.now() / 1000, NaN);
  }

  #stopSubscription(): void {
    this.#unsubscribe?.();
    this.#unsubscribe = undefined;
  }

  #receive(message: Message): void {
    this.error = "";
    this.missing = "";
    const time = timeOf(message, Date.now() / 1000);
    // A curve of two runs would be none of both.
    if (this.#stamps.hasGoneBack(stampOf(message))) {
      for (const { samples } of this.#curves) samples.clear();
    }
    this.#newest = { message, time };
    for (const curve of this.#curves) this.#record(curve, message, time);
    this.#changed();
  }

  #record(curve: Curve, message: Message, time: number): void {
    if (curve.record(message, time)) this.missing = curve.path;
  }
}

/** The time of a message: that of its header if it is plausible, else the time of its arrival. */
export function timeOf(message: Message, now: number): number {
  const stamp = stampOf(message);
  return stamp !== undefined && Math.abs(stamp - now) <= MAX_SKEW ? stamp : now;
}

/** The stamp of a message's header, in seconds. */
function stampOf(message: Message): number | undefined {
  return numberAt(own(message, "header"), ["stamp"]);
}
