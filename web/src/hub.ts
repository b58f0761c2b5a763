/**
 * The page's one connection to the hub: it comes back by itself, and what was subscribed to and
 * advertised comes back with it.
 */
import type { Ros } from "roslib";

import { Listeners } from "./listeners";
import { type Signal, Source } from "./signal";

export type Message = Record<string, unknown>;
export type State = "connecting" | "open" | "closed";

export interface Publication {
  publish(message: Message): void;
  close(): void;
}

export interface SubscribeOptions {
  /** Least time between two messages, in ms. */
  throttle?: number;
  /** Messages that the hub keeps for a page that falls behind. */
  queue?: number;
}

type Operation = Parameters<Ros["callOnConnection"]>[0];

interface Call {
  readonly operation: Operation;
  sent: boolean;
  fail(why: Error): void;
}

interface Advertisement {
  readonly operation: Operation;
}

/** Seconds that a service has for its answer. */
const PATIENCE = 60;
/** Time between two attempts, in ms: doubled up to the last. */
const FIRST_PAUSE = 250;
const LAST_PAUSE = 4000;
/** Close codes from here on say that one should not come back by oneself. */
const FOR_GOOD = 4000;

/** Neither a service nor the hub has answered a call in time. */
export class NoAnswer extends Error {
  constructor(service: string, type: string, patience: number) {
    super(`${service} (${type}) did not answer within ${patience} s`);
  }
}

export class Hub {
  readonly url: string;
  readonly node = `/page_${randomHex()}`;
  readonly state: Signal<State>;
  /** What was said when the connection was lost; empty if nothing was. */
  readonly reason: Signal<string>;
  /** Whether the hub has said that one should not come back by oneself. */
  readonly ended: Signal<boolean>;

  readonly #ros: Ros;
  readonly #state = new Source<State>("connecting");
  readonly #reason = new Source("");
  readonly #ended = new Source(false);
  readonly #calls = new Map<string, Call>();
  readonly #listeners = new Map<string, Listeners<Operation>>();
  readonly #advertisements = new Set<Advertisement>();
  #ids = 0;
  #pause = FIRST_PAUSE;
  #attempt: number | undefined;

  /** `url` is the hub's WebSocket address; `ros` speaks to it. */
  constructor(url: string, ros: Ros) {
    this.url = url;
    this.#ros = ros;
    this.state = this.#state;
    this.reason = this.#reason;
    this.ended = this.#ended;
    ros.on("connection", () => this.#opened());
    ros.on("close", (event) => this.#closed(event as unknown as CloseEvent));
    // A failed attempt is told by "close", too; without a listener it would be thrown.
    ros.on("error", () => undefined);
    this.connect();
  }

  /** Try to connect now, rather than when the next attempt is due. */
  connect(): void {
    window.clearTimeout(this.#attempt);
    this.#ros.connect(asNode(this.url, this.node)).catch(() => this.#retry());
  }

  /** Give up a connection on which nothing comes back any more, and connect anew. */
  drop(why: string): void {
    if (this.#state.value !== "open") return;
    this.#lose(why);
    this.#ros.close();
  }

  /**
   * Call a service; gives its response.
   *
   * Rejects with an `Error` that has the provider's or the hub's text; with `NoAnswer` when
   * nothing came for `patience` seconds and a little.
   */
  call<T>(service: string, type: string, request: Message = {}, patience = PATIENCE): Promise<T> {
    const id = this.#id("call");
    return new Promise<T>((resolve, reject) => {
      const late = () => call.fail(new NoAnswer(service, type, patience));
      const timer = window.setTimeout(late, (patience + 2) * 1000);
      const done = () => {
        window.clearTimeout(timer);
        this.#calls.delete(id);
        this.#ros.off(id);
        this.#ros.off(`status:${id}`);
      };
      const call: Call = {
        operation: {
          op: "call_service",
          id,
          service,
          args: request,
          timeout: patience,
        } as Operation,
        sent: false,
        fail: (why) => {
          done();
          reject(why);
        },
      };
      this.#calls.set(id, call);
      this.#ros.on(id, (answer) => {
        const { result, values } = answer as unknown as { result: boolean; values: unknown };
        if (result) {
          done();
          resolve(values as T);
        } else {
          const why = typeof values === "string" && values !== "" ? values : `${service} failed`;
          call.fail(new Error(why));
        }
      });
      this.#ros.on(`status:${id}`, (status) => call.fail(new Error(text(status))));
      this.#send(call);
    });
  }

  /**
   * Hear a topic, until the function that is given back is called.
   *
   * No type is named: a subscriber that names one keeps nodes from giving the topic another.
   *
   * `refused` hears why the hub will not have it, each time that it is asked. The hub knows one
   * rate per topic and client; a listener that wants fewer messages than another gets fewer.
   */
  subscribe(
    topic: string,
    { throttle = 0, queue = 0 }: SubscribeOptions,
    hear: (message: Message) => void,
    refused?: (why: string) => void,
  ): () => void {
    const id = this.#id("subscribe");
    let listeners = this.#listeners.get(topic);
    if (listeners === undefined) {
      const fresh = new Listeners<Operation>();
      listeners = fresh;
      this.#listeners.set(topic, fresh);
      this.#ros.on(topic, (heard) => {
        fresh.tell((heard as unknown as { msg: Message }).msg);
      });
    }
    const operation = {
      op: "subscribe",
      id,
      topic,
      throttle_rate: throttle,
      queue_length: queue,
    } as Operation;
    listeners.add(id, operation, throttle, hear);
    this.#hearRefusals(id, refused);
    this.#say(operation);
    return () => {
      if (!listeners.remove(id)) return;
      this.#ros.off(`status:${id}`);
      this.#say({ op: "unsubscribe", id, topic } as Operation);
      if (listeners.empty && this.#listeners.get(topic) === listeners) {
        this.#listeners.delete(topic);
        this.#ros.off(topic);
      }
    };
  }

  /** Register as a topic's publisher; `refused` hears what the hub does not take, and why. */
  advertise(topic: string, type: string, refused?: (why: string) => void): Publication {
    const id = this.#id("advertise");
    const advertisement = { operation: { op: "advertise", id, topic, type } as Operation };
    this.#advertisements.add(advertisement);
    this.#hearRefusals(id, refused);
    this.#say(advertisement.operation);
    return {
      publish: (message) => {
        if (this.#state.value !== "open") {
          refused?.("There is no connection to the hub now: nothing was published");
          return;
        }
        this.#say({ op: "publish", id, topic, msg: message } as Operation);
      },
      close: () => {
        if (!this.#advertisements.delete(advertisement)) return;
        this.#ros.off(`status:${id}`);
        this.#say({ op: "unadvertise", id, topic } as Operation);
      },
    };
  }

  #hearRefusals(id: string, refused: ((why: string) => void) | undefined): void {
    if (refused !== undefined) {
      this.#ros.on(`status:${id}`, (status) => refused(text(status)));
    }
  }

  /** Send what need not be sent again: it is, from the registers, when the hub is back. */
  #say(operation: Operation): void {
    if (this.#state.value === "open") this.#ros.callOnConnection(operation);
  }

  #send(call: Call): void {
    if (this.#state.value === "open") {
      call.sent = true;
      this.#ros.callOnConnection(call.operation);
    }
  }

  #opened(): void {
    this.#pause = FIRST_PAUSE;
    for (const advertisement of this.#advertisements) {
      this.#ros.callOnConnection(advertisement.operation);
    }
    for (const listeners of this.#listeners.values()) {
      for (const operation of listeners.operations()) this.#ros.callOnConnection(operation);
    }
    this.#reason.set("");
    this.#ended.set(false);
    this.#state.set("open");
    for (const call of this.#calls.values()) {
      if (!call.sent) this.#send(call);
    }
  }

  #closed({ code, reason }: CloseEvent): void {
    this.#lose(reason);
    if (code < FOR_GOOD) this.#retry();
    else this.#ended.set(true);
  }

  #lose(why: string): void {
    // The attempts that follow have nothing to say of why it was lost.
    if (this.#state.value === "open" || why !== "") this.#reason.set(why);
    this.#state.set("closed");
    for (const call of [...this.#calls.values()]) {
      if (call.sent) call.fail(new Error("The connection was lost before the answer came"));
    }
  }

  #retry(): void {
    this.#state.set("closed");
    window.clearTimeout(this.#attempt);
    this.#attempt = window.setTimeout(() => this.connect(), this.#pause);
    this.#pause = Math.min(2 * this.#pause, LAST_PAUSE);
  }

  #id(what: string): string {
    this.#ids += 1;
    return `${what}:${this.#ids}`;
  }
}

function text(status: unknown): string {
  return String((status as { msg?: unknown }).msg ?? "The hub refused, without a reason");
}

/** The address at which a hub takes a client for the node of that name. */
export function asNode(url: string, node: string): string {
  return `${url}${url.includes("?") ? "&" : "?"}node=${node}`;
}

export function randomHex(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(4));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
