/** Shows what was kept or recorded at any moment, in place of what comes now; it runs in the worker. */
import type { Playback } from "../clock";
import type { Delivery, Subscriber } from "./feed";
import type { Inbox } from "./inbox";
import { isStatic, type Kept, type Store, type Wish } from "./store";
import { hasText } from "./values";

/** Who takes messages. */
export interface Taker {
  readonly subscriber: Subscriber;
  readonly inbox: Inbox<Delivery>;
}

export type Command =
  | { readonly kind: "pause" }
  /** `speed` is how many seconds pass in one; `loop`: begin again at the end. */
  | { readonly kind: "play"; readonly speed: number; readonly loop: boolean }
  /** Show a moment, in ms since 1970. */
  | { readonly kind: "seek"; readonly time: number }
  /** Show the next or the previous message of a topic, or of any topic that is shown. */
  | { readonly kind: "step"; readonly topic: string; readonly by: 1 | -1 }
  /** Show the next message of a topic, or of any topic that is shown, that has a text or a number. */
  | { readonly kind: "find"; readonly topic: string; readonly text: string }
  /** Show what comes now. */
  | { readonly kind: "live" };

/** Messages that are being processed while further ones are read. */
const MAX_IN_FLIGHT = 500;
/** Playing waits for panels that take longer than this, in ms, instead of skipping messages. */
const LATE = 50;
/** Time after which the worker receives commands, in ms. */
const SLICE = 20;
/** The longest wait for panels after a jump, in ms. */
const PATIENCE = 500;
/** Time between two reports while time passes, in ms: in a recording, and live. */
const REPORT = 100;
const REPORT_LIVE = 1000;
/** Less than the time between any two messages, in ms. */
const MOMENT = 0.0005;

export class Player {
  readonly #store: Store;
  readonly #hasLive: boolean;
  readonly #takers: () => Iterable<Taker>;
  readonly #post: (report: { kind: "jump" } | { kind: "clock"; playback: Playback }) => void;
  #isLive: boolean;
  /** The shown moment, if not live, and when that was reached, by `performance.now()`. */
  #position: number;
  #reached = 0;
  /** 0 while paused. */
  #speed = 0;
  #loop = false;
  /** Counts what ends playing and jumps that are under way. */
  #turn = 0;
  #search: NonNullable<Playback["search"]> = "";
  /** The moment to which to jump next. */
  #target: number | undefined;
  #isJumping = false;
  /** The speed at which playing goes on after a jump. */
  #resume = 0;
  readonly #added = new Set<Taker>();
  #inFlight = 0;
  /** Called when a message has been processed, or playing ends. */
  #onTaken: (() => void)[] = [];
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** `hasLive`: the store grows with what comes, which is shown at first. */
  constructor(
    store: Store,
    hasLive: boolean,
    takers: () => Iterable<Taker>,
    post: (report: { kind: "jump" } | { kind: "clock"; playback: Playback }) => void,
  ) {
    this.#store = store;
    this.#hasLive = hasLive;
    this.#isLive = hasLive;
    this.#position = store.start;
    this.#takers = takers;
    this.#post = post;
    this.#report();
  }

  /** Whether messages are shown as they come. */
  get isLive(): boolean {
    return this.#isLive;
  }

  /** Somebody takes messages from now on: show the newest ones at this moment. */
  add(taker: Taker): void {
    if (this.#isLive) return;
    this.#added.add(taker);
    // Several panels open together.
    if (this.#added.size === 1) queueMicrotask(() => void this.#show());
  }

  async control(command: Command): Promise<void> {
    switch (command.kind) {
      case "pause":
        this.#pause();
        break;
      case "play":
        this.#loop = command.loop;
        this.#stop();
        if (this.#position >= this.#end && !this.#hasLive) await this.#seek(this.#store.start);
        this.#play(command.speed);
        break;
      case "seek":
        await this.#seek(command.time);
        break;
      case "step":
        await this.#step(command.topic, command.by);
        break;
      case "find":
        await this.#find(command.topic, command.text);
        break;
      case "live":
        await this.#goLive();
    }
  }

  get #end(): number {
    return this.#hasLive ? Math.max(this.#store.end, Date.now()) : this.#store.end;
  }

  #now(): number {
    if (this.#speed === 0) return this.#position;
    const passed = this.#speed * (performance.now() - this.#reached);
    return Math.min(this.#position + passed, this.#end);
  }

  #moveTo(time: number): void {
    this.#position = time;
    this.#reached = performance.now();
  }

  /** End playing, and what is under way. */
  #stop(): void {
    this.#turn += 1;
    this.#search = "";
    this.#moveTo(this.#isLive ? Date.now() : this.#now());
    this.#speed = 0;
    this.#isLive = false;
    this.#wake();
  }

  #pause(): void {
    this.#resume = 0;
    this.#stop();
    this.#report();
  }

  /** Jump to a moment; playing goes on there. */
  async #seek(time: number): Promise<void> {
    this.#target = time;
    if (this.#isJumping) return;
    this.#isJumping = true;
    this.#resume = this.#speed;
    try {
      while (this.#target !== undefined) {
        const target: number = this.#target;
        this.#target = undefined;
        this.#stop();
        this.#moveTo(Math.min(Math.max(target, this.#store.start), this.#end));
        await this.#jump(this.#turn);
      }
    } finally {
      this.#isJumping = false;
    }
    if (this.#resume > 0) this.#play(this.#resume);
  }

  /** Show the messages of this moment. Returns whether nothing else has begun meanwhile. */
  async #jump(turn: number): Promise<boolean> {
    const takers = this.#begin();
    this.#report();
    const found = await this.#store.before(wantedBy(takers), this.#position);
    if (turn !== this.#turn) return false;
    return this.#deliverAll(found, takers, () => turn === this.#turn && this.#target === undefined);
  }

  /** Show messages of a moment, as fast as panels take them; ends early if they do not count any more. */
  async #deliverAll(
    found: readonly Kept[],
    takers: readonly Taker[],
    counts: () => boolean,
  ): Promise<boolean> {
    const done: Promise<void>[] = [];
    for (const kept of found) {
      for (const each of this.#deliver(kept, takers)) done.push(each);
      if (this.#inFlight >= MAX_IN_FLIGHT) await Promise.race([this.#taken(), pause(PATIENCE)]);
      if (!counts()) return false;
    }
    await Promise.race([Promise.all(done), pause(PATIENCE)]);
    return counts();
  }

  /** Begin with another moment; returns all who take messages. */
  #begin(): Taker[] {
    this.#added.clear();
    const takers = [...this.#takers()];
    for (const { subscriber } of takers) subscriber.jump?.();
    this.#post({ kind: "jump" });
    return takers;
  }

  async #goLive(): Promise<void> {
    if (!this.#hasLive || this.#isLive) return;
    this.#resume = 0;
    this.#stop();
    const turn = this.#turn;
    this.#moveTo(this.#end);
    const takers = this.#begin();
    const found = await this.#store.before(wantedBy(takers), Infinity);
    if (turn !== this.#turn) return;
    // In one go with the messages that come next.
    for (const kept of found) this.#deliver(kept, takers);
    this.#isLive = true;
    this.#report();
  }

  /** Show the messages of this moment to those who have come. */
  async #show(): Promise<void> {
    const takers = [...this.#added];
    this.#added.clear();
    const turn = this.#turn;
    const found = await this.#store.before(wantedBy(takers), this.#now());
    const isDone = await this.#deliverAll(found, takers, () => turn === this.#turn);
    if (!isDone) return;
    // They take what is played, too.
    if (this.#speed > 0 && !this.#isLive) {
      const speed = this.#speed;
      this.#stop();
      this.#play(speed);
    }
  }

  async #step(topic: string, by: 1 | -1): Promise<void> {
    this.#pause();
    const turn = this.#turn;
    const shown = this.#shown;
    const topics = topic === "" ? shown : new Set([topic]);
    if (by < 0) {
      const wanted = new Map([...topics].map((each) => [each, { count: 1, span: 0 }]));
      const earlier = await this.#store.before(wanted, this.#position - MOMENT);
      const time = earlier.filter((kept) => kept.time < this.#position).at(-1)?.time;
      if (turn === this.#turn && time !== undefined) await this.#seek(time);
      return;
    }
    for await (const kept of this.#store.after(new Set([...shown, ...topics]), this.#position)) {
      if (turn !== this.#turn) return;
      this.#moveTo(kept.time);
      this.#deliver(kept, this.#takers());
      if (topics.has(kept.topic)) break;
      if (this.#inFlight >= MAX_IN_FLIGHT) await this.#taken();
    }
    this.#report();
  }

  /** The topics that are shown. */
  get #shown(): Set<string> {
    return new Set([...this.#takers()].map(({ subscriber }) => subscriber.topic));
  }

  async #find(topic: string, text: string): Promise<void> {
    this.#pause();
    const turn = this.#turn;
    this.#search = "searching";
    this.#report();
    let slice = performance.now();
    const topics = topic === "" ? this.#shown : new Set([topic]);
    for await (const kept of this.#store.after(topics, this.#position)) {
      if (performance.now() - slice > SLICE) {
        await pause(0);
        slice = performance.now();
      }
      if (turn !== this.#turn) return;
      if (!has(kept, text)) continue;
      await this.#seek(kept.time);
      return;
    }
    if (turn !== this.#turn) return;
    this.#search = "not found";
    this.#report();
  }

  #play(speed: number): void {
    this.#turn += 1;
    this.#moveTo(this.#position);
    this.#speed = speed;
    this.#report();
    void this.#run(this.#turn);
  }

  async #run(turn: number): Promise<void> {
    const topics = this.#shown;
    let slice = performance.now();
    for await (const kept of this.#store.after(topics, this.#position)) {
      if (turn !== this.#turn) return;
      const due = this.#reached + (kept.time - this.#position) / this.#speed;
      const wait = due - performance.now();
      if (wait > 1 || performance.now() - slice > SLICE) {
        await pause(Math.max(0, wait));
        slice = performance.now();
        if (turn !== this.#turn) return;
      }
      this.#deliver(kept, this.#takers());
      if (this.#inFlight >= MAX_IN_FLIGHT) await this.#taken();
      if (turn !== this.#turn) return;
      this.#position = kept.time;
      // All that follows is later by what this one is late.
      const late = performance.now() - due;
      this.#reached = late > LATE ? performance.now() : due;
    }
    const rest = this.#reached + (this.#end - this.#position) / this.#speed - performance.now();
    if (!this.#hasLive && rest > 0) await pause(rest);
    if (turn !== this.#turn) return;
    if (this.#hasLive) await this.#goLive();
    else if (this.#loop) await this.#seek(this.#store.start);
    else {
      this.#moveTo(this.#end);
      this.#speed = 0;
      this.#report();
    }
  }

  /** Wait until a message has been processed, or playing ends. */
  #taken(): Promise<void> {
    return new Promise((resolve) => {
      this.#onTaken.push(resolve);
    });
  }

  #wake(): void {
    for (const resume of this.#onTaken.splice(0)) resume();
  }

  #deliver(kept: Kept, takers: Iterable<Taker>): Promise<void>[] {
    const { topic, type, size, time, node } = kept;
    const done: Promise<void>[] = [];
    for (const { subscriber, inbox } of takers) {
      if (subscriber.topic !== topic) continue;
      // JSON does not say its type.
      if (subscriber.type && type !== "" && subscriber.type !== type) {
        subscriber.fail(`the topic had the type ${type} then`);
        continue;
      }
      this.#inFlight += 1;
      const read = (): Delivery => ({ message: kept.read(), size, time, node });
      const processed = new Promise<void>((resolve) => inbox.offer(read, false, resolve));
      done.push(
        processed.then(() => {
          this.#inFlight -= 1;
          this.#wake();
        }),
      );
    }
    return done;
  }

  #report(): void {
    clearTimeout(this.#timer);
    const { start, bytes } = this.#store;
    const [isLive, speed, end] = [this.#isLive, this.#speed, this.#end];
    const time = isLive ? end : this.#now();
    const playback = { isLive, speed, start, end, bytes, time, search: this.#search };
    this.#post({ kind: "clock", playback });
    const isPlaying = !isLive && speed > 0;
    if (isPlaying || this.#hasLive)
      this.#timer = setTimeout(() => this.#report(), isPlaying ? REPORT : REPORT_LIVE);
  }
}

/** What is wanted of each topic at a moment: one message, or what may wait in the queue. */
function wantedBy(takers: Iterable<Taker>): Map<string, Wish> {
  const wanted = new Map<string, Wish>();
  for (const { subscriber } of takers) {
    const { topic, queue, span = 0 } = subscriber;
    const other = wanted.get(topic) ?? { count: 0, span: 0 };
    const count = isStatic(topic) ? Infinity : Math.max(queue, other.count);
    wanted.set(topic, { count, span: Math.max(span, other.span) });
  }
  return wanted;
}

/** Whether a message has a text, or a number that is written so; unreadable ones have nothing. */
function has(kept: Kept, text: string): boolean {
  try {
    return hasText(kept.read(), text);
  } catch {
    return false;
  }
}

function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}
