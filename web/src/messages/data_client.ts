/** The page's side of its connection for messages, which is in a worker. */
import type { Clock } from "../clock";
import { dataWorker } from "../script_urls";
import type { Signal } from "../signal";
import type { Delivery, Subscription } from "./feed";
import type { Fields } from "./reader";
import type { FileRequest, RecordingReport } from "./recording_messages";
import type { Batch, ClockReport, Report, Request } from "./worker_messages";

interface Numbered {
  readonly kind: string;
  readonly id: number;
}

type Unnumbered<T> = T extends { id: number } ? Omit<T, "id"> : never;

/** Sends further requests about what is open. */
export type Send<Request> = (request: Unnumbered<Request>) => void;

/** What the worker needs of a hub for a connection of its own. */
export interface Link {
  readonly state: Signal<string>;
  readonly denied: Signal<string>;
  /** The address and the token. */
  second(): { url: string; token: string };
}

/** What streams messages from the worker. */
export interface Streams {
  open: DataClient["open"];
}

export class DataClient {
  readonly #worker: Worker;
  readonly #listeners = new Map<number, (report: Numbered) => void>();
  #ids = 0;

  /** `onRecording` takes reports about a file that is played. */
  constructor(clock: Clock, onRecording?: (report: RecordingReport) => void) {
    this.#worker = new Worker(dataWorker, { type: "module" });
    type Received = ClockReport | RecordingReport | Batch | Numbered;
    this.#worker.onmessage = ({ data }: MessageEvent<Received>) => {
      if ("id" in data) this.#listeners.get(data.id)?.(data);
      else if (data.kind === "batch") this.#take(data);
      else if (data.kind === "recording") onRecording?.(data);
      else if (data.kind === "clock") clock.report(data.playback);
      else clock.jump();
    };
    this.#worker.onerror = ({ message }) => {
      const why = message || "the worker did not start";
      for (const [id, listener] of this.#listeners) {
        listener({ kind: "fault", id, why } as Numbered);
      }
    };
  }

  #take({ reports }: Batch): void {
    for (const each of reports) {
      try {
        this.#listeners.get(each.id)?.(each);
      } catch (error) {
        // The others are not concerned.
        reportError(error);
      }
    }
    this.send({ kind: "taken batch" });
  }

  /** Connect the worker whenever the page connects to its hub. */
  follow(link: Link): void {
    // Again each time: the hub may want another token by then.
    link.state.watch((state) => {
      if (state === "open") this.send({ kind: "connect", ...link.second() });
    });
    link.denied.watch((why) => {
      if (why !== "") this.send({ kind: "disconnect" });
    });
  }

  /** End the worker, and its connection. */
  close(): void {
    this.#worker.terminate();
  }

  /** Send what is about no single stream. */
  send(request: Exclude<Request, { id: number }> | FileRequest): void {
    this.#worker.postMessage(request);
  }

  /** Open something in the worker; returns a function for further requests. */
  open<Sent extends Numbered, Received extends Numbered>(
    request: Unnumbered<Sent>,
    transfer: Transferable[],
    listener: (report: Received) => void,
  ): Send<Sent> {
    this.#ids += 1;
    const id = this.#ids;
    this.#listeners.set(id, listener as (report: Numbered) => void);
    this.#worker.postMessage({ ...request, id }, transfer);
    return (next) => {
      if (next.kind === "close") this.#listeners.delete(id);
      this.#worker.postMessage({ ...next, id });
    };
  }
}

/** A subscription of the page: every message without a throttle, and the newest alone without a queue. */
export type Wanted = Pick<Subscription, "topic"> & Partial<Subscription>;

/**
 * Subscribe to the messages of a topic; return a function that unsubscribes.
 *
 * `fail` receives the reason why there are no messages; an empty text if there are again. `ready` is
 * called when the hub has subscribed, after each time that the connection was lost, too.
 */
export function subscribe(
  source: Streams,
  { throttle = 0, queue = 1, ...wanted }: Wanted,
  receive: (message: Fields, delivery: Delivery) => void,
  fail: (why: string) => void = () => undefined,
  ready: () => void = () => undefined,
): () => void {
  type Sent = Extract<Request, { id: number }>;
  const request = { kind: "messages", throttle, queue, ...wanted } as const;
  const send = source.open<Sent, Report>(request, [], (report) => {
    if (report.kind === "fault") fail(report.why);
    if (report.kind === "ready") ready();
    if (report.kind === "message") receive(report.delivery.message, report.delivery);
  });
  return () => send({ kind: "close" });
}
