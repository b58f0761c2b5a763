/** Records what is plotted of one topic; the worker takes it out of the messages. */
import type { DataClient, Send } from "../messages/data_client";
import { Expression } from "./expression";
import { RingBuffer } from "./ring_buffer";
import type { Piece, Report, Request, Wanted } from "./sample_messages";

/** Samples of a curve: those of 10 minutes at 1.7 kHz. */
const CAPACITY = 2 ** 20;

/** Where samples come from, and their time. */
export interface SampleSource {
  readonly open: DataClient["open"];
  readonly clock: {
    readonly playback: { readonly value: { readonly isLive: boolean } };
    /** The present, in ms since 1970. */
    now(): number;
    /** Call a listener when time jumps: what comes then is of another time; returns what ends this. */
    onJump(listener: () => void): () => void;
  };
}

/** Records something of each message of a topic. */
export interface Recorder {
  /** What it records, in words: `position[elbow]`. */
  readonly path: string;
  readonly wanted: Wanted;
  /** Record what the next messages had. */
  take(piece: Piece): void;
  /** There are no messages for a while, from a time in seconds on. */
  pause(time: number): void;
  /** Forget everything. */
  clear(): void;
}

export class Curve implements Recorder {
  readonly samples = new RingBuffer(CAPACITY);
  /** The newest elements, if it is of an array: they are plotted over their index. */
  elements: Float64Array | undefined;
  readonly isArray: boolean;
  /** With the names of array elements once there was a message: `position[elbow]`. */
  path: string;
  readonly #text: string;

  /** Throws an `ExpressionError` if the text is invalid. */
  constructor(text: string) {
    const expression = new Expression(text);
    this.path = this.#text = expression.text;
    this.isArray = expression.isArray;
  }

  get wanted(): Wanted {
    return { kind: "curve", text: this.path };
  }

  /** Whether it is what an expression means, with names or without. */
  isOf(text: string): boolean {
    return text === this.path || text === this.#text;
  }

  take({ path, samples = NO_SAMPLES, rests, elements }: Piece): void {
    this.path = path;
    for (let at = 0; 2 * at < samples.length; at += 1)
      this.samples.add(samples[2 * at] as number, samples[2 * at + 1] as number, rests?.[at]);
    if (elements !== undefined) this.elements = elements;
  }

  pause(time: number): void {
    if (this.samples.length > 0) this.samples.pushGap(time);
  }

  clear(): void {
    this.samples.clear();
    this.elements = undefined;
  }
}

const NO_SAMPLES = new Float64Array();

export class Sampler {
  readonly topic: string;
  /** Why the hub rejected the subscription; empty if it did not. */
  error = "";
  /** A path at which the newest message had no number; empty if there is none. */
  missing = "";
  readonly #source: SampleSource;
  readonly #changed: () => void;
  readonly #found: (twin: Recorder) => void;
  readonly #recorders = new Map<number, Recorder>();
  #keys = 0;
  #span = 0;
  #send: Send<Request> | undefined;
  #unwatch: (() => void) | undefined;

  /**
   * `changed` is called when there are samples, and `found` with what turns out to be the same as
   * another one, now that its elements have names.
   */
  constructor(
    source: SampleSource,
    topic: string,
    changed: () => void,
    found: (twin: Recorder) => void,
  ) {
    this.#source = source;
    this.topic = topic;
    this.#changed = changed;
    this.#found = found;
  }

  /** Let something be recorded, beginning with the newest message: a slow topic has a value at once. */
  add<T extends Recorder>(recorder: T): T {
    this.#keys += 1;
    this.#recorders.set(this.#keys, recorder);
    this.#send?.({ kind: "add", key: this.#keys, wanted: recorder.wanted });
    return recorder;
  }

  /** Record something no longer. Returns whether it was the last: then the subscription has ended. */
  remove(recorder: Recorder): boolean {
    for (const [key, each] of this.#recorders) {
      if (each !== recorder) continue;
      this.#recorders.delete(key);
      this.#send?.({ kind: "remove", key });
    }
    if (this.#recorders.size > 0) return false;
    this.stop();
    return true;
  }

  /** Have what was recorded in so many seconds before a moment, if that is not the present. */
  reach(seconds: number): void {
    if (seconds <= this.#span) return;
    this.#span = seconds;
    if (this.#send === undefined || this.#source.clock.playback.value.isLive) return;
    this.#end();
    for (const recorder of this.#recorders.values()) recorder.clear();
    this.start();
  }

  start(): void {
    if (this.#send !== undefined) return;
    // What comes then is of another time.
    this.#unwatch = this.#source.clock.onJump(() => {
      for (const recorder of this.#recorders.values()) recorder.clear();
      this.#changed();
    });
    const wanted = [...this.#recorders].map(([key, each]) => [key, each.wanted] as const);
    const request = { kind: "samples", topic: this.topic, span: this.#span, wanted } as const;
    this.#send = this.#source.open<Request, Report>(request, [], (report) => this.#take(report));
  }

  stop(): void {
    if (this.#send === undefined) return;
    this.#end();
    for (const recorder of this.#recorders.values())
      recorder.pause(this.#source.clock.now() / 1000);
  }

  #end(): void {
    this.#send?.({ kind: "close" });
    this.#send = undefined;
    this.#unwatch?.();
  }

  #hasTwin(recorder: Recorder): boolean {
    const all = [...this.#recorders.values()];
    return all.some((each) => each !== recorder && each.path === recorder.path);
  }

  #take(report: Report): void {
    this.error = report.kind === "fault" ? report.why : "";
    if (report.kind === "samples") {
      this.missing = report.missing;
      for (const [key, piece] of report.pieces) {
        const recorder = this.#recorders.get(key);
        if (recorder === undefined) continue;
        const isRenamed = piece.path !== recorder.path;
        if (piece.isNew) recorder.clear();
        recorder.take(piece);
        if (isRenamed && this.#hasTwin(recorder)) this.#found(recorder);
      }
    }
    this.#changed();
  }
}
