/**
 * The page's connection for messages: by fibws.v1, whose frames have them serialized, to the bit as
 * they were sent. It runs in a worker, so that no image waits for the page, or the page for it.
 *
 * A server without fibws.v1 sends JSON instead, and so does the hub if it does not know a type.
 */

import { readDefinition } from "./definition";
import { Inbox } from "./inbox";
import { type Fields, makeReader, type Reader } from "./reader";
import type { Kept } from "./store";

export const PROTOCOL = "fibws.v1";
/** Bytes of a frame before the message: its kind, the topic's id, and when the hub received it. */
export const HEAD = 13;
const MESSAGE = 1;
/** The same, followed by the size of the publisher's connection header, and that. */
const MESSAGE_WITH_HEADER = 2;
/** Messages of a topic that the hub sends before the first of them is processed... */
const CREDIT = 2;
/** ...and at most for those who want each of them. */
const MAX_CREDIT = 500;
/** Processed messages are acknowledged once they are this part of the credit, or after so many ms. */
const ACKNOWLEDGED = 1 / 8;
const ACKNOWLEDGE_TIME = 250;

/** A message takes the time at which the hub had it, unless it came later than this, in ms. */
const MAX_DELAY = 2000;

/** The least and the most time between two attempts to connect, in ms. */
const MIN_RETRY = 250;
const MAX_RETRY = 4000;
/** The hub closes with a code from here on if a client must not reconnect by itself. */
const NO_RECONNECT = 4000;

/** Which messages a subscriber wants. */
export interface Subscription {
  readonly topic: string;
  /** The type that the topic must have; any without it. */
  readonly type?: string | undefined;
  /** The least time between two messages, in ms. */
  readonly throttle: number;
  /**
   * How many messages wait while others are processed, here and at the hub: 1 for the newest alone.
   * Of more, the oldest are dropped.
   */
  readonly queue: number;
  /** Of how long before a moment all messages count, in ms, when what is kept or recorded is shown. */
  readonly span?: number;
  /** Whether it needs the names of the nodes that publish. */
  readonly headers?: boolean;
}

/** A message, and how it came. */
export interface Delivery {
  readonly message: Fields;
  /** Bytes on the way here. */
  readonly size: number;
  /** When the hub received it, by this computer's clock: in ms since 1970. */
  readonly time: number;
  /** The node that published it, if the subscription asks for that. */
  readonly node: string;
}

export interface Subscriber extends Subscription {
  /**
   * Take a message.
   *
   * No more than the queue's length come before their promises are resolved, so that messages become
   * fewer, and not older, if they are processed slowly.
   */
  receive(delivery: Delivery): void | Promise<void>;
  /** Take the reason why there are no messages; an empty text if there are again. */
  fail(why: string): void;
  /** Time jumps: what comes next does not follow what came before. */
  jump?(): void;
  /** The hub has subscribed: what is published from now on comes. */
  ready?(): void;
}

/** What keeps messages, and shows them again. */
export interface FeedPlayer {
  /** Whether messages are shown as they come. */
  readonly isLive: boolean;
  /** There is another subscriber. */
  add(taker: Pick<Entry, "subscriber" | "inbox">): void;
  /** Keep a message. */
  record(message: Kept): void;
}

/** Where the worker takes messages from. */
export interface Messages {
  /** Subscribe; returns a function that unsubscribes. */
  subscribe(subscriber: Subscriber): () => void;
}

interface Entry {
  readonly id: string;
  readonly subscriber: Subscriber;
  readonly inbox: Inbox<Delivery>;
  reader: Reader | undefined;
  /** The type of the messages. */
  type: string;
  /** The id of the topic in frames. */
  topicId: number | undefined;
  /** Whether the hub cannot serialize its messages. */
  isJson: boolean;
  /** Whether the subscriber was told last that the connection was lost. */
  isLost: boolean;
  /** Whether no message has come since it was subscribed. */
  isNew: boolean;
}

/** A message as it came, for all who want it. */
interface Incoming {
  readonly key: string;
  readonly size: number;
  readonly time: number;
  readonly node: string;
  /** Read it; `isShared` if others read it, too. */
  read(reader: Reader | undefined, isShared: boolean): Fields;
}

export class Feed implements Messages {
  player: FeedPlayer | undefined;
  #url = "";
  #token = "";
  readonly #entries = new Map<string, Entry>();
  #socket: WebSocket | undefined;
  /** The topics whose messages are to be acknowledged, by their ids in frames. */
  readonly #credited = new Map<number, string>();
  /** How many messages of each topic are processed, but not acknowledged. */
  readonly #processed = new Map<string, number>();
  #acknowledging: ReturnType<typeof setTimeout> | undefined;
  /** What came last on each topic. */
  readonly #last = new Map<string, string>();
  /** The least time that a message has taken from the hub, by the clocks of both, in ms. */
  #delay = Infinity;
  #ids = 0;
  #retryTime = MIN_RETRY;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /**
   * Connect, and connect again whenever the connection is lost, unless the hub forbids that.
   *
   * Nothing happens if there is a connection. `url` has the name of its node.
   */
  connect(url: string, token: string): void {
    this.#url = url;
    this.#token = token;
    if (this.#socket !== undefined) return;
    clearTimeout(this.#timer);
    this.#connect();
  }

  /** End the connection until `connect`; the subscriptions stay. */
  close(): void {
    clearTimeout(this.#timer);
    const socket = this.#socket;
    this.#socket = undefined;
    socket?.close();
  }

  /** All who have subscribed. */
  get takers(): Iterable<Pick<Entry, "subscriber" | "inbox">> {
    return this.#entries.values();
  }

  /** Subscribe; returns a function that unsubscribes. */
  subscribe(subscriber: Subscriber): () => void {
    this.#ids += 1;
    const id = `feed:${this.#ids}`;
    const { queue, throttle } = subscriber;
    const inbox = new Inbox<Delivery>(
      queue,
      throttle,
      (delivery) => subscriber.receive(delivery),
      (why) => subscriber.fail(why),
    );
    const state = { reader: undefined, topicId: undefined, type: "", isJson: false, isLost: false };
    const entry: Entry = { id, subscriber, inbox, ...state, isNew: true };
    this.#entries.set(id, entry);
    this.#request(entry);
    this.player?.add(entry);
    return () => {
      if (!this.#entries.delete(id)) return;
      this.#send({ op: "unsubscribe", id, topic: subscriber.topic });
      inbox.close();
    };
  }

  #connect(): void {
    const socket = new WebSocket(this.#url, PROTOCOL);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    this.#credited.clear();
    this.#processed.clear();
    this.#delay = Infinity;
    socket.onopen = () => {
      this.#retryTime = MIN_RETRY;
      if (this.#token !== "") this.#send({ op: "auth", token: this.#token });
      for (const entry of this.#entries.values()) {
        // If there is another reason, the hub says it again.
        if (entry.isLost) entry.subscriber.fail("");
        entry.isLost = false;
        entry.isJson = false;
        this.#request(entry);
      }
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === "string")
        this.#receive(JSON.parse(data) as Record<string, unknown>, data);
      else this.#receiveFrame(new Uint8Array(data));
    };
    socket.onclose = ({ code, reason }) => {
      if (this.#socket !== socket) return;
      this.#socket = undefined;
      for (const entry of this.#entries.values()) {
        entry.topicId = undefined;
        entry.isLost = true;
        entry.subscriber.fail(reason || "the connection was lost");
      }
      if (code >= NO_RECONNECT) return;
      this.#timer = setTimeout(() => this.#connect(), this.#retryTime);
      this.#retryTime = Math.min(2 * this.#retryTime, MAX_RETRY);
    };
  }

  #request({ id, subscriber, isJson }: Entry): void {
    const { topic, throttle, queue, headers = false } = subscriber;
    const credit = creditOf(subscriber);
    const isBinary = this.#socket?.protocol === PROTOCOL && !isJson;
    this.#send({
      op: "subscribe",
      id,
      topic,
      throttle_rate: throttle,
      queue_length: queue,
      ...(headers ? { headers } : {}),
      ...(isBinary ? { compression: "ros1", send_definition: true, credit } : {}),
    });
    // JSON has no reply.
    if (!isBinary && this.#socket?.readyState === WebSocket.OPEN) subscriber.ready?.();
  }

  #send(operation: Record<string, unknown>): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(operation));
  }

  #receive(operation: Record<string, unknown>, text: string): void {
    const entry = this.#entries.get(operation.id as string);
    switch (operation.op) {
      case "subscribed":
        if (operation.credit !== undefined)
          this.#credited.set(operation.topic_id as number, operation.topic as string);
        if (entry !== undefined) this.#prepare(entry, operation);
        break;
      case "status":
        if (entry !== undefined) this.#onStatus(entry, operation);
        break;
      case "publish":
        this.#receiveJson(operation, text);
        break;
    }
  }

  #onStatus(entry: Entry, { level, msg, code }: Record<string, unknown>): void {
    // Others say that the topic has no type yet, or that somebody else's message was repaired.
    if (level !== "error") return;
    if (code === "unknown_definition" && !entry.isJson) {
      entry.isJson = true;
      this.#request(entry);
      return;
    }
    entry.subscriber.fail(String(msg));
  }

  #prepare(entry: Entry, { topic_id, type, definition }: Record<string, unknown>): void {
    const expected = entry.subscriber.type ?? type;
    if (expected !== type) {
      // A topic may have several types: messages of the expected one are shown all the same.
      entry.subscriber.fail(`the topic has the type ${String(type)} now`);
      return;
    }
    entry.topicId = topic_id as number;
    entry.type = String(type);
    entry.reader = undefined;
    try {
      entry.reader = makeReader(readDefinition(String(type), String(definition)));
    } catch (error) {
      entry.subscriber.fail((error as Error).message);
    }
    entry.subscriber.ready?.();
  }

  #receiveJson({ topic, msg, header }: Record<string, unknown>, text: string): void {
    const takers = [...this.#entries.values()].filter(
      ({ subscriber }) => subscriber.topic === topic,
    );
    const node = (header as { callerid?: string } | undefined)?.callerid ?? "";
    const read = (_: unknown, isShared: boolean): Fields =>
      (isShared ? structuredClone(msg) : msg) as Fields;
    // Nobody says its type.
    const incoming = { key: text, size: text.length, time: Date.now(), node, read };
    this.#dispatch(String(topic), takers, incoming, () => undefined);
  }

  #receiveFrame(frame: Uint8Array): void {
    const kind = frame[0];
    if (frame.length < HEAD || (kind !== MESSAGE && kind !== MESSAGE_WITH_HEADER)) return;
    const view = new DataView(frame.buffer);
    const topicId = view.getUint32(1, true);
    const received = view.getBigUint64(5, true);
    let start = HEAD;
    let node = "";
    if (kind === MESSAGE_WITH_HEADER) {
      start = HEAD + 2 + view.getUint16(HEAD, true);
      const header = new TextDecoder().decode(frame.subarray(HEAD + 2, start));
      node = (JSON.parse(header) as { callerid?: string }).callerid ?? "";
    }
    const takers = [...this.#entries.values()].filter(
      (entry) => entry.topicId === topicId && entry.reader !== undefined,
    );
    const read = (reader: Reader | undefined, isShared: boolean): Fields =>
      // Each may keep the bytes, or transfer them.
      (reader as Reader)(isShared ? frame.slice(start) : frame.subarray(start));
    const key = `${received} ${frame.length}`;
    const incoming = { key, size: frame.length, time: this.#timeOf(received), node, read };
    let credit = CREDIT;
    for (const { subscriber } of takers) credit = Math.max(credit, creditOf(subscriber));
    const socket = this.#socket;
    this.#dispatch(takers[0]?.subscriber.topic ?? "", takers, incoming, () => {
      if (this.#socket === socket) this.#acknowledge(topicId, credit);
    });
  }

  /** When the hub had a message, by this computer's clock; now if that was long ago. */
  #timeOf(received: bigint): number {
    const now = Date.now();
    const time = Number(received / 1000n) / 1000;
    this.#delay = Math.min(this.#delay, now - time);
    return now - (time + this.#delay) < MAX_DELAY ? time + this.#delay : now;
  }

  /** Give a message to those who want it; `done` is called once all of them have processed it. */
  #dispatch(topic: string, all: readonly Entry[], incoming: Incoming, done: () => void): void {
    const added = all.filter(({ isNew }) => isNew);
    // The hub sends a latched message again for each new subscription: only that one gets it.
    const isRepeated =
      added.length > 0 && added.length < all.length && this.#last.get(topic) === incoming.key;
    this.#last.set(topic, incoming.key);
    const [first] = all;
    if (first !== undefined && !isRepeated) {
      const { size, time, node } = incoming;
      const { reader, type } = first;
      const read = (): Fields => incoming.read(reader, true);
      this.player?.record({ topic, type, size, time, node, read });
    }
    const takers = isRepeated ? added : all;
    let rest = takers.length;
    if (rest === 0 || this.player?.isLive === false) {
      done();
      return;
    }
    const finish = (): void => {
      rest -= 1;
      if (rest === 0) done();
    };
    const shortest = all.reduce(
      (least, { subscriber }) => Math.min(least, subscriber.throttle),
      Infinity,
    );
    for (const entry of takers) {
      entry.isNew = false;
      const { size, time, node } = incoming;
      const read = (): Delivery => {
        const message = incoming.read(entry.reader, takers.length > 1 || this.player !== undefined);
        return { message, size, time, node };
      };
      // The hub throttles to the shortest time; throttling to that again would delay messages.
      entry.inbox.offer(read, entry.subscriber.throttle > shortest, finish);
    }
  }

  /** Acknowledge a message that is processed: together with others, if the hub has credit for more. */
  #acknowledge(topicId: number, credit: number): void {
    const topic = this.#credited.get(topicId);
    if (topic === undefined) return;
    const count = (this.#processed.get(topic) ?? 0) + 1;
    this.#processed.set(topic, count);
    // Those that are processed at once are acknowledged together.
    if (count >= ACKNOWLEDGED * credit) queueMicrotask(() => this.#sendAcknowledgement(topic));
    this.#acknowledging ??= setTimeout(() => {
      this.#acknowledging = undefined;
      for (const each of [...this.#processed.keys()]) this.#sendAcknowledgement(each);
    }, ACKNOWLEDGE_TIME);
  }

  #sendAcknowledgement(topic: string): void {
    const count = this.#processed.get(topic) ?? 0;
    this.#processed.delete(topic);
    if (count > 0) this.#send({ op: "acknowledge", topic, count });
  }
}

/** Messages that the hub sends before the first of them is processed. */
function creditOf({ queue }: Subscription): number {
  return queue === 1 ? CREDIT : Math.min(queue, MAX_CREDIT);
}
