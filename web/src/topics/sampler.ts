/** Subscribes to one topic and records the numbers that are plotted. */
import { resolve } from "../element_names";
import type { Message } from "../hub";
import { subscribe } from "../messages/data_client";
import { numberAt, secondsOf } from "../messages/values";
import { Stamps } from "../simulated_time";
import type { DataSource } from "../source";
import { own, parsePath, pathText, type Step } from "../types";
import { RingBuffer } from "./ring_buffer";

/** Samples of a curve: those of 10 minutes at 1.7 kHz. */
const CAPACITY = 2 ** 20;
/** How many messages wait while the page is busy: it needs each of them. */
const QUEUE = 10_000;
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
    if (value === undefined) {
      this.samples.pushGap(time);
      return true;
    }
    this.samples.push(time, value);
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
  readonly #hub: DataSource;
  readonly #changed: () => void;
  readonly #curves = new Set<Curve>();
  readonly #stamps = new Stamps();
  #unsubscribe: (() => void) | undefined;
  #unwatch: (() => void) | undefined;
  #newest: { readonly message: Message; readonly time: number } | undefined;

  /** `changed` is called for each message. */
  constructor(hub: DataSource, topic: string, changed: () => void) {
    this.#hub = hub;
    this.topic = topic;
    this.#changed = changed;
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
    // What comes then is of another time.
    this.#unwatch ??= this.#hub.clock.onJump(() => {
      this.#newest = undefined;
      for (const { samples } of this.#curves) samples.clear();
      this.#changed();
    });
    this.#unsubscribe ??= subscribe(
      this.#hub,
      { topic: this.topic, queue: QUEUE },
      (message, { time }) => this.#receive(message, time / 1000),
      (why) => {
        this.error = why;
        this.#changed();
      },
    );
  }

  stop(): void {
    if (this.#unsubscribe === undefined) return;
    this.#unsubscribe();
    this.#unsubscribe = undefined;
    this.#unwatch?.();
    this.#unwatch = undefined;
    // The time without a subscription is a gap in the curve.
    for (const { samples } of this.#curves)
      if (samples.length > 0) samples.pushGap(this.#hub.clock.now() / 1000);
  }

  #receive(message: Message, arrived: number): void {
    this.error = "";
    this.missing = "";
    const time = timeOf(message, arrived);
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
export function timeOf(message: Message, arrived: number): number {
  const stamp = stampOf(message);
  return stamp !== undefined && Math.abs(stamp - arrived) <= MAX_SKEW ? stamp : arrived;
}

/** The stamp of a message's header, in seconds. */
function stampOf(message: Message): number | undefined {
  return secondsOf(own(own(message, "header"), "stamp"));
}
