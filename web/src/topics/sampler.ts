/** Subscribes to one topic and records the numbers that are plotted. */
import type { Message } from "../hub";
import { secondsOf } from "../messages/values";
import { Stamps } from "../simulated_time";
import { own } from "../types";
import { ABSENT, Expression, WAITING } from "./expression";
import type { PlotSource } from "./plot_source";
import { RingBuffer } from "./ring_buffer";

/** Samples of a curve: those of 10 minutes at 1.7 kHz. */
const CAPACITY = 2 ** 20;
/** A header's time is used if it differs from the clock by no more than this, in seconds. */
const MAX_SKEW = 5;

/** Records something of each message of a topic. */
export interface Recorder {
  /** What it records, in words: `position[elbow]`. */
  readonly path: string;
  /** Record a message. Returns whether it should have had something to record, but has not. */
  record(message: Message, time: number): boolean;
  /** There are no messages for a while. */
  pause(time: number): void;
  /** Forget everything. */
  clear(): void;
}

export class Curve implements Recorder {
  readonly samples = new RingBuffer(CAPACITY);
  /** The newest elements, if it is of an array: they are plotted over their index. */
  elements: Float64Array | undefined;
  readonly #expression: Expression;

  /** Throws an `ExpressionError` if the text is invalid. */
  constructor(text: string) {
    this.#expression = new Expression(text);
  }

  /** With the names of array elements once there was a message: `position[elbow]`. */
  get path(): string {
    return this.#expression.text;
  }

  get isArray(): boolean {
    return this.#expression.isArray;
  }

  record(message: Message, time: number): boolean {
    const value = this.#expression.evaluate(message, time);
    // Messages of other nodes have other elements: they leave no gap.
    if (value === ABSENT) return this.samples.length === 0;
    if (value === WAITING) return false;
    if (value === undefined) {
      this.#expression.reset();
      if (!this.isArray) this.samples.pushGap(time);
      return true;
    }
    if (typeof value === "object") this.elements = value;
    else this.samples.push(time, value);
    return false;
  }

  pause(time: number): void {
    this.#expression.reset();
    if (this.samples.length > 0) this.samples.pushGap(time);
  }

  clear(): void {
    this.#expression.reset();
    this.samples.clear();
    this.elements = undefined;
  }
}

export class Sampler {
  readonly topic: string;
  /** Why the hub rejected the subscription; empty if it did not. */
  error = "";
  /** A path at which the newest message had no number; empty if there is none. */
  missing = "";
  readonly #source: PlotSource;
  readonly #changed: () => void;
  readonly #recorders = new Set<Recorder>();
  readonly #stamps = new Stamps();
  #unsubscribe: (() => void) | undefined;
  #unwatch: (() => void) | undefined;
  #newest: { readonly message: Message; readonly time: number } | undefined;

  /** `changed` is called for each message. */
  constructor(source: PlotSource, topic: string, changed: () => void) {
    this.#source = source;
    this.topic = topic;
    this.#changed = changed;
  }

  /** Let something be recorded, beginning with the newest message: a slow topic has a value at once. */
  add<T extends Recorder>(recorder: T): T {
    this.#recorders.add(recorder);
    if (this.#newest !== undefined) this.#record(recorder, this.#newest.message, this.#newest.time);
    return recorder;
  }

  /** An expression with the names of array elements, if there was a message. */
  named(text: string): string {
    const expression = new Expression(text);
    if (this.#newest !== undefined) expression.evaluate(this.#newest.message, this.#newest.time);
    return expression.text;
  }

  /** Record something no longer. Returns whether it was the last: then the subscription has ended. */
  remove(recorder: Recorder): boolean {
    this.#recorders.delete(recorder);
    if (this.#recorders.size > 0) return false;
    this.stop();
    return true;
  }

  start(): void {
    // What comes then is of another time.
    this.#unwatch ??= this.#source.onJump(() => {
      this.#newest = undefined;
      for (const recorder of this.#recorders) recorder.clear();
      this.#changed();
    });
    this.#unsubscribe ??= this.#source.subscribe(
      this.topic,
      (message, time) => this.#receive(message, time),
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
    for (const recorder of this.#recorders) recorder.pause(this.#source.now());
  }

  #receive(message: Message, arrived: number): void {
    this.error = "";
    this.missing = "";
    const time = timeOf(message, arrived);
    // A curve of two runs would be none of both.
    if (this.#stamps.hasGoneBack(stampOf(message))) {
      for (const recorder of this.#recorders) recorder.clear();
    }
    this.#newest = { message, time };
    for (const recorder of this.#recorders) this.#record(recorder, message, time);
    this.#changed();
  }

  #record(recorder: Recorder, message: Message, time: number): void {
    if (recorder.record(message, time)) this.missing = recorder.path;
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
