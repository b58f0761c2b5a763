/**
 * The page's connection to the hub for calls and for what it publishes, by the rosbridge protocol.
 *
 * It reconnects by itself, and then advertises again. Messages come on another connection.
 */
import { Clock } from "./clock";
import { DataClient } from "./messages/data_client";
import { type Signal, Source } from "./signal";

export type Message = Record<string, unknown>;
export type State = "connecting" | "open" | "closed";

/** An operation of the rosbridge protocol. */
export type Operation = { op: string } & Record<string, unknown>;

export interface Publication {
  publish(message: Message): void;
  /**
   * Leave a message that the hub publishes when the page has gone, or has published nothing for
   * `timeout` seconds. It ends with the connection.
   */
  setWill(message: Message, timeout: number): void;
  clearWill(): void;
  close(): void;
}

/** A goal of an action that is served by ROS 2's operations. */
export interface GoalRequest {
  action: string;
  type: string;
  values: Message;
}

/** How a goal ended. */
export interface GoalEnd {
  /** A number of action_msgs/GoalStatus. */
  status: number;
  /** Whether `values` is the action's result; else it is the reason. */
  result: boolean;
  values: unknown;
}

interface SentGoal {
  onFeedback(feedback: Message): void;
  onEnd(end: GoalEnd): void;
}

interface Call {
  readonly operation: Operation;
  sent: boolean;
  resolve(values: unknown): void;
  reject(error: Error): void;
}

/** Seconds that a service has to respond. */
const TIMEOUT = 60;
/** Most time between two attempts to connect, in ms: doubled each time, up to the maximum. */
const MIN_RETRY = 250;
const MAX_RETRY = 4000;
/** The hub closes with a code from here on if a client must not reconnect by itself... */
const NO_RECONNECT = 4000;

/** ...except with this one: a limit is reached for now. */
const LIMITED = 4429;

/** The code with which the hub closes if it wants a token, or another one. */
const UNAUTHENTICATED = 4401;

/** Bytes that may wait in the browser. */
const MAX_BUFFERED = 64 * 1024;

/** `WebSocket.CONNECTING` and `WebSocket.OPEN`. */
const CONNECTING = 0;
const OPEN = 1;

/** The status of a goal that was not executed, of action_msgs/GoalStatus. */
const ABORTED = 6;

/** Neither the service nor the hub responded in time. */
export class CallTimeout extends Error {
  constructor(service: string, type: string, seconds: number) {
    super(`${service} (${type}) did not respond within ${seconds} s`);
  }
}

export class Hub {
  readonly url: string;
  readonly node = `/page_${randomHex()}`;
  /** The node of the page's other connection, on which messages come. */
  readonly #messageNode = `/page_${randomHex()}`;
  readonly state: Signal<State>;
  /** Why the connection was lost, if the hub gave a reason. */
  readonly reason: Signal<string>;
  /** Whether the page has stopped reconnecting. */
  readonly ended: Signal<boolean>;
  /** How many attempts in a row to connect have failed. */
  readonly failures: Signal<number>;
  /** Why the hub wants a token, or another one; empty if it does not. */
  readonly denied: Signal<string>;
  /** The time that is shown. */
  readonly clock = new Clock();

  readonly #state = new Source<State>("connecting");
  readonly #reason = new Source("");
  readonly #ended = new Source(false);
  readonly #failures = new Source(0);
  readonly #denied = new Source("");
  /** Calls without a response, by their ids. */
  readonly #calls = new Map<string, Call>();
  /** Goals that have not ended, by their ids. */
  readonly #goals = new Map<string, SentGoal>();
  readonly #advertised = new Map<string, Operation>();
  /** Who receives the errors about an operation, by its id. */
  readonly #onError = new Map<string, (why: string) => void>();
  #data: DataClient | undefined;
  #socket: WebSocket | undefined;
  #ids = 0;
  #retryTime = MIN_RETRY;
  #retryTimer: number | undefined;
  /** The token to send first; empty if there is none, or if the browser sends a cookie. */
  #token: string;

  /** `url` is the hub's WebSocket address. */
  constructor(url: string, token = "") {
    this.url = url;
    this.#token = token;
    this.denied = this.#denied;
    this.state = this.#state;
    this.reason = this.#reason;
    this.ended = this.#ended;
    this.failures = this.#failures;
    this.connect();
  }

  /** Whether there are nodes that take messages, calls and goals. */
  readonly canPublish: boolean = true;

  /** Whether so much waits to be sent that what is sent now would arrive late. */
  get isCongested(): boolean {
    return (this.#socket?.bufferedAmount ?? 0) > MAX_BUFFERED;
  }

  /** Connect now, instead of at the next attempt. */
  connect(): void {
    window.clearTimeout(this.#retryTimer);
    this.#abandon();
    try {
      this.#open(new WebSocket(withNode(this.url, this.node)));
    } catch (error) {
      // The browser rejects the address: another attempt would fail as well.
      this.#disconnected((error as Error).message);
      this.#ended.set(true);
    }
  }

  /** The connection on which messages come, which is opened when it is first needed. */
  get data(): DataClient {
    if (this.#data === undefined) {
      this.#data = new DataClient(this.clock);
      this.#data.follow(this);
    }
    return this.#data;
  }

  /** Stream messages; returns a function for further requests. */
  readonly open: DataClient["open"] = (request, transfer, listener) =>
    this.data.open(request, transfer, listener);

  /** The address and the token for another connection of the page, which is a node of its own. */
  second(): { url: string; token: string } {
    return { url: withNode(this.url, this.#messageNode), token: this.#token };
  }

  /** Whether a node is this page. */
  isOwn(node: string): boolean {
    return node === this.node || node === this.#messageNode;
  }

  /** Connect with a token, which is sent by the operation `auth`. */
  enter(token: string): void {
    this.#token = token;
    this.connect();
  }

  /** Disconnect until there is another token. */
  deny(why: string): void {
    window.clearTimeout(this.#retryTimer);
    this.#abandon();
    this.#disconnected(why);
    this.#end(why);
  }

  /** Disconnect for good. */
  end(): void {
    this.deny("");
    this.#data?.close();
  }

  /** Replace a connection that no longer responds by a new one. */
  drop(why: string): void {
    if (this.#state.value !== "open") return;
    this.#abandon();
    this.#disconnected(why);
    this.#retry();
  }

  /**
   * Call a service; return its response.
   *
   * Rejects with an `Error` that has the text of the service or of the hub, or with `CallTimeout`.
   */
  call<T>(service: string, type: string, request: Message = {}, timeout = TIMEOUT): Promise<T> {
    const id = this.#newId("call");
    return new Promise<T>((resolve, reject) => {
      // The hub reports a timeout itself, unless the connection is dead.
      const onTimeout = () => call.reject(new CallTimeout(service, type, timeout));
      const timer = window.setTimeout(onTimeout, (timeout + 2) * 1000);
      const finish = () => {
        window.clearTimeout(timer);
        this.#calls.delete(id);
        this.#onError.delete(id);
      };
      const call: Call = {
        operation: { op: "call_service", id, service, args: request, timeout },
        sent: false,
        resolve: (values) => {
          finish();
          resolve(values as T);
        },
        reject: (error) => {
          finish();
          reject(error);
        },
      };
      this.#calls.set(id, call);
      this.#onError.set(id, (why) => call.reject(new Error(why)));
      this.#sendCall(call);
    });
  }

  /**
   * Send a goal by ROS 2's operations; return a function that asks the server to cancel it.
   *
   * `onEnd` is called once, also when the hub rejects the goal or the connection is lost.
   */
  sendGoal(
    { action, type, values }: GoalRequest,
    onFeedback: (feedback: Message) => void,
    onEnd: (end: GoalEnd) => void,
  ): () => void {
    if (this.#state.value !== "open") {
      onEnd(unknownEnd("Not connected to the hub: the goal was not sent"));
      return () => undefined;
    }
    const id = this.#newId("goal");
    this.#goals.set(id, { onFeedback, onEnd });
    const goal = { action, action_type: type, args: values, feedback: true };
    this.#onError.set(id, (why) =>
      this.#endGoal(id, { status: ABORTED, result: false, values: why }),
    );
    this.#send({ op: "send_action_goal", id, ...goal });
    return () => {
      if (this.#goals.has(id)) this.#send({ op: "cancel_action_goal", id, action });
    };
  }

  /** Advertise a topic; `onError` receives the reason when the hub rejects that or a message. */
  advertise(topic: string, type: string, onError?: (why: string) => void): Publication {
    const id = this.#newId("advertise");
    const operation = { op: "advertise", id, topic, type };
    this.#advertised.set(id, operation);
    if (onError !== undefined) this.#onError.set(id, onError);
    this.#send(operation);
    return {
      publish: (message) => {
        if (this.#state.value === "open") this.#send({ op: "publish", id, topic, msg: message });
        else onError?.("Not connected to the hub: the message was not published");
      },
      setWill: (msg, timeout) => this.#send({ op: "set_will", id, topic, type, msg, timeout }),
      clearWill: () => this.#send({ op: "clear_will", id, topic }),
      close: () => {
        if (!this.#advertised.delete(id)) return;
        this.#onError.delete(id);
        this.#send({ op: "unadvertise", id, topic });
      },
    };
  }

  #open(socket: WebSocket): void {
    this.#socket = socket;
    socket.onopen = () => this.#connected();
    socket.onmessage = ({ data }: MessageEvent<string>) => this.#receive(JSON.parse(data));
    socket.onclose = ({ code, reason }) => {
      this.#disconnected(reason);
      if (code < NO_RECONNECT || code === LIMITED) this.#retry();
      else this.#end(code === UNAUTHENTICATED ? reason : "");
    };
  }

  /** Stop reconnecting; `denied` is why the hub wants another token, if that is the reason. */
  #end(denied: string): void {
    this.#ended.set(true);
    this.#denied.set(denied);
  }

  /** Close the socket, if there is one, and ignore whatever it still does. */
  #abandon(): void {
    const socket = this.#socket;
    if (socket === undefined) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    // A browser warns if a connection is closed before it is open.
    if (socket.readyState === CONNECTING) socket.onopen = () => socket.close();
    else socket.close();
    this.#socket = undefined;
  }

  #receive(operation: Operation): void {
    const { op, id } = operation;
    switch (op) {
      case "service_response":
        this.#respond(this.#calls.get(id as string), operation);
        break;
      case "action_feedback":
        this.#goals.get(id as string)?.onFeedback(operation.values as Message);
        break;
      case "action_result":
        this.#endGoal(id as string, {
          status: Number(operation.status),
          result: operation.result === true,
          values: operation.values,
        });
        break;
      case "status":
        this.#onError.get(id as string)?.(String(operation.msg));
        break;
    }
  }

  #endGoal(id: string, end: GoalEnd): void {
    const goal = this.#goals.get(id);
    this.#goals.delete(id);
    this.#onError.delete(id);
    goal?.onEnd(end);
  }

  #respond(call: Call | undefined, { result, values, service }: Operation): void {
    if (result === true) call?.resolve(values);
    else call?.reject(new Error(values ? String(values) : `${String(service)} failed`));
  }

  /** Send an operation if connected; advertisements are sent on connecting. */
  #send(operation: Operation): void {
    // A socket that the hub is closing is "open" until that is done; a browser warns of such use.
    if (this.#state.value !== "open" || this.#socket?.readyState !== OPEN) return;
    this.#socket.send(JSON.stringify(operation));
  }

  #sendCall(call: Call): void {
    call.sent = this.#state.value === "open";
    this.#send(call.operation);
  }

  #connected(): void {
    this.#retryTime = MIN_RETRY;
    const operations: Operation[] = [...this.#advertised.values()];
    if (this.#token !== "") operations.unshift({ op: "auth", token: this.#token });
    for (const operation of operations) this.#socket?.send(JSON.stringify(operation));
    this.#reason.set("");
    this.#ended.set(false);
    this.#denied.set("");
    this.#failures.set(0);
    this.#state.set("open");
    for (const call of this.#calls.values()) if (!call.sent) this.#sendCall(call);
  }

  #disconnected(why: string): void {
    // Attempts that fail later have no reason: the first one stays.
    const wasOpen = this.#state.value === "open";
    if (wasOpen || why !== "") this.#reason.set(why);
    this.#state.set("closed");
    if (!wasOpen) this.#failures.set(this.#failures.value + 1);
    for (const call of [...this.#calls.values()]) {
      if (call.sent) call.reject(new Error("The connection was lost before the response arrived"));
    }
    // The hub cancels the goals of a client that leaves.
    for (const id of [...this.#goals.keys()]) {
      this.#endGoal(id, unknownEnd("The connection was lost before the goal ended"));
    }
  }

  #retry(): void {
    window.clearTimeout(this.#retryTimer);
    // Pages that lost the hub together must not all come back at once.
    const wait = this.#retryTime * (0.75 + Math.random() / 4);
    this.#retryTimer = window.setTimeout(() => this.connect(), wait);
    this.#retryTime = Math.min(2 * this.#retryTime, MAX_RETRY);
  }

  #newId(kind: string): string {
    this.#ids += 1;
    return `${kind}:${this.#ids}`;
  }
}

/** The end of a goal whose status nobody knows. */
function unknownEnd(why: string): GoalEnd {
  return { status: 0, result: false, values: why };
}

const DEFAULT_PORT = "9090";

/**
 * The WebSocket address of a hub as a user writes it: `robot` is `ws://robot:9090/`, as for `--hub`.
 *
 * Throws an `Error` if the address is invalid.
 */
export function hubUrl(address: string, secure = false): string {
  const text = address.trim();
  const hasScheme = text.includes("://");
  const url = parsed(hasScheme ? text : `${secure ? "wss" : "ws"}://${text}`);
  const isHub = url?.protocol === "ws:" || url?.protocol === "wss:";
  if (!isHub || url.hash !== "" || url.port === "0" || /^\d+$|\s/.test(text)) {
    throw new Error(`Invalid hub address “${text}”: expected host:port or ws://host:port`);
  }
  // The text is asked, since a URL drops the port that is its scheme's default.
  const hasPort = /^[^/?]*:\d+([/?]|$)/.test(text);
  if (!hasScheme && !hasPort) url.port = DEFAULT_PORT;
  return url.href;
}

function parsed(text: string): URL | undefined {
  try {
    return new URL(text);
  } catch {
    return undefined;
  }
}

/** Whether a hub's address is where programs find it by themselves. */
export function isDefaultHub(url: string): boolean {
  const { hostname, port } = new URL(url);
  return port === DEFAULT_PORT && ["localhost", "127.0.0.1", "[::1]"].includes(hostname);
}

/** A hub's address without the token in it, which must not be shown, and the token. */
export function splitToken(address: string): { url: string; token: string } {
  const url = new URL(address);
  const token = url.searchParams.get("token") ?? "";
  url.searchParams.delete("token");
  return { url: url.href, token };
}

/** The address with the name that the client's node is to have. */
export function withNode(url: string, node: string): string {
  return `${url}${url.includes("?") ? "&" : "?"}node=${node}`;
}

export function randomHex(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(4));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
