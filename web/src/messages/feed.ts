/**
 * A second connection to the hub, for messages that are large or many: by fibws.v1, whose frames
 * have them serialized. It runs in a worker, so that no image waits for the page, or the page for it.
 *
 * A server without fibws.v1 sends JSON instead.
 */

import type { TypeDef } from "../types";
import { type Fields, makeReader, type Reader } from "./reader";

export const PROTOCOL = "fibws.v1";
/** Bytes of a frame before the message: its kind, the topic's id, and when the hub received it. */
export const HEAD = 13;
const MESSAGE = 1;
/** Messages of a topic that the hub sends before the first of them is processed. */
const CREDIT = 2;

/** The least and the most time between two attempts to connect, in ms. */
const MIN_RETRY = 250;
const MAX_RETRY = 4000;
/** The hub closes with a code from here on if a client must not reconnect by itself. */
const NO_RECONNECT = 4000;

export interface Subscriber {
  readonly topic: string;
  /** The definition of the topic's type, which comes first. */
  readonly typedefs: readonly TypeDef[];
  /** The least time between two messages, in ms. */
  readonly throttle: number;
  /** How many messages the hub keeps while they cannot be sent; 1 without it. */
  readonly queue?: number;
  /**
   * Take a message; `size` is its bytes on the way here.
   *
   * The hub waits for the promise before it sends more than another one, so that messages become
   * fewer, and not older, if they are processed slowly.
   */
  receive(message: Fields, size: number): void | Promise<void>;
  /** Take the reason why there are no messages; an empty text if there are again. */
  fail(why: string): void;
}

interface Entry {
  readonly id: string;
  readonly subscriber: Subscriber;
  reader: Reader | undefined;
  /** The id of the topic in frames. */
  topicId: number | undefined;
  /** Whether the subscriber was told last that the connection was lost. */
  isLost: boolean;
}

export class Feed {
  #url = "";
  #token = "";
  readonly #entries = new Map<string, Entry>();
  #socket: WebSocket | undefined;
  /** The topics whose messages are to be acknowledged, by their ids in frames. */
  readonly #credited = new Map<number, string>();
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

  /** Subscribe; returns a function that unsubscribes. Each message is the newest one. */
  subscribe(subscriber: Subscriber): () => void {
    this.#ids += 1;
    const id = `feed:${this.#ids}`;
    const entry: Entry = { id, subscriber, reader: undefined, topicId: undefined, isLost: false };
    this.#entries.set(id, entry);
    this.#request(entry);
    return () => {
      if (!this.#entries.delete(id)) return;
      this.#send({ op: "unsubscribe", id, topic: subscriber.topic });
    };
  }

  #connect(): void {
    const socket = new WebSocket(this.#url, PROTOCOL);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    this.#credited.clear();
    socket.onopen = () => {
      this.#retryTime = MIN_RETRY;
      if (this.#token !== "") this.#send({ op: "auth", token: this.#token });
      for (const entry of this.#entries.values()) {
        // If there is another reason, the hub says it again.
        if (entry.isLost) entry.subscriber.fail("");
        entry.isLost = false;
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

  get #isBinary(): boolean {
    return this.#socket?.protocol === PROTOCOL;
  }

  #request({ id, subscriber }: Entry): void {
    const { queue = 1 } = subscriber;
    // With credit, only the newest message waits.
    const credit = queue === 1 ? { credit: CREDIT } : {};
    this.#send({
      op: "subscribe",
      id,
      topic: subscriber.topic,
      throttle_rate: subscriber.throttle,
      queue_length: queue,
      ...(this.#isBinary ? { compression: "ros1", ...credit } : {}),
    });
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
        entry?.subscriber.fail(String(operation.msg));
        break;
      case "publish":
        for (const each of this.#entries.values()) {
          const { topic } = each.subscriber;
          if (topic === operation.topic)
            void this.#dispatch(each, () => operation.msg as Fields, text.length);
        }
        break;
    }
  }

  #prepare(entry: Entry, { topic_id, type }: Record<string, unknown>): void {
    const { typedefs } = entry.subscriber;
    if (typedefs[0]?.type !== type) {
      // A topic may have several types: messages of the expected one are shown all the same.
      entry.subscriber.fail(`the topic has the type ${String(type)} now`);
      return;
    }
    entry.topicId = topic_id as number;
    entry.reader = undefined;
    try {
      entry.reader = makeReader(typedefs);
    } catch (error) {
      entry.subscriber.fail((error as Error).message);
    }
  }

  #receiveFrame(frame: Uint8Array): void {
    if (frame.length < HEAD || frame[0] !== MESSAGE) return;
    const topicId = new DataView(frame.buffer).getUint32(1, true);
    const processed: Promise<void>[] = [];
    const takers = [...this.#entries.values()].filter((entry) => entry.topicId === topicId);
    for (const [at, entry] of takers.entries()) {
      const { reader } = entry;
      if (reader === undefined) continue;
      // Each may keep the bytes, or transfer them.
      const own = at < takers.length - 1 ? frame.slice() : frame;
      processed.push(this.#dispatch(entry, () => reader(own.subarray(HEAD)), frame.length));
    }
    void this.#acknowledge(topicId, processed);
  }

  /** Acknowledge a message once all subscribers have processed it, or if there are none left. */
  async #acknowledge(topicId: number, processed: readonly Promise<void>[]): Promise<void> {
    const socket = this.#socket;
    await Promise.all(processed);
    const topic = this.#credited.get(topicId);
    if (this.#socket === socket && topic !== undefined) this.#send({ op: "acknowledge", topic });
  }

  async #dispatch({ subscriber }: Entry, read: () => Fields, size: number): Promise<void> {
    try {
      await subscriber.receive(read(), size);
    } catch (error) {
      subscriber.fail((error as Error).message);
    }
  }
}
