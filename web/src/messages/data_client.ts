/** The page's side of its second connection, which is in a worker. */
import type { Hub } from "../hub";
import { dataWorker } from "../script_urls";
import type { Fields } from "./reader";
import type { Report, Request, Subscription } from "./worker_messages";

type Listener = (report: Report) => void;
type Unnumbered<T> = T extends { id: number } ? Omit<T, "id"> : never;

const clients = new WeakMap<Hub, DataClient>();

/** The one connection of a hub's page, which is opened when it is first needed. */
export function dataClient(hub: Hub): DataClient {
  let client = clients.get(hub);
  if (client === undefined) {
    client = new DataClient(hub);
    clients.set(hub, client);
  }
  return client;
}

export class DataClient {
  readonly #worker: Worker;
  readonly #listeners = new Map<number, Listener>();
  #ids = 0;

  constructor(hub: Hub) {
    this.#worker = new Worker(dataWorker, { type: "module" });
    this.#worker.onmessage = ({ data }: MessageEvent<Report>) =>
      this.#listeners.get(data.id)?.(data);
    this.#worker.onerror = ({ message }) => {
      const why = message || "the worker did not start";
      for (const [id, listener] of this.#listeners) listener({ kind: "fault", id, why });
    };
    // Again whenever the page has connected: the hub may want another token by then.
    hub.state.watch((state) => {
      if (state !== "open") return;
      this.#worker.postMessage({ kind: "connect", ...hub.second() } satisfies Request);
    });
    hub.denied.watch((why) => {
      if (why !== "") this.#worker.postMessage({ kind: "disconnect" } satisfies Request);
    });
  }

  /** Open something in the worker; returns a function for further requests. */
  open(
    request: Unnumbered<Request & { kind: "picture" | "messages" }>,
    transfer: Transferable[],
    listener: Listener,
  ): (request: Unnumbered<Request>) => void {
    this.#ids += 1;
    const id = this.#ids;
    this.#listeners.set(id, listener);
    this.#worker.postMessage({ ...request, id }, transfer);
    return (next) => {
      if (next.kind === "close") this.#listeners.delete(id);
      this.#worker.postMessage({ ...next, id });
    };
  }

  /**
   * Subscribe to the messages of a topic; return a function that unsubscribes.
   *
   * `fail` receives the reason why there are no messages.
   */
  subscribe(
    subscription: Subscription,
    receive: (message: Fields) => void,
    fail: (why: string) => void,
  ): () => void {
    const send = this.open({ kind: "messages", ...subscription }, [], (report) => {
      if (report.kind === "fault") fail(report.why);
      if (report.kind !== "message") return;
      try {
        receive(report.message);
      } finally {
        send({ kind: "taken" });
      }
    });
    return () => send({ kind: "close" });
  }
}
