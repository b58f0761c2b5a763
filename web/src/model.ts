/** The graph as the hub tells it, and how much flows in it. */
import { Log } from "./console/log";
import { type Hub, NoAnswer } from "./hub";
import { type ClientStatistics, Meter, NO_RATES, type Rates, type Statistics } from "./rates";
import { type Signal, Source } from "./signal";
import type { TypeDef } from "./types";

export type { ClientStatistics, Flow, Rates } from "./rates";

export interface Time {
  secs: number;
  nsecs: number;
}

export interface NodeInfo {
  name: string;
  /** IP and port; empty for the hub's own. */
  address: string;
  since: Time;
  /** Whether it is one of the hub's own. */
  own: boolean;
}

export interface PublisherInfo {
  node: string;
  latch: boolean;
}

export interface SubscriptionInfo {
  node: string;
  queue_length: number;
  /** In ms. */
  throttle_rate: number;
  compression: string;
}

export interface TopicInfo {
  name: string;
  /** Empty if it has none yet. */
  type: string;
  checked: boolean;
  publishers: PublisherInfo[];
  subscriptions: SubscriptionInfo[];
}

export interface ServiceInfo {
  name: string;
  type: string;
  node: string;
}

export interface ActionInfo {
  name: string;
  type: string;
  node: string;
  /** As in ROS 1, rather than by operations as in ROS 2. */
  over_topics: boolean;
}

export interface Graph {
  revision: number;
  nodes: NodeInfo[];
  topics: TopicInfo[];
  services: ServiceInfo[];
  actions: ActionInfo[];
}

/** Time from one answer to the next question, in ms. */
const INTERVAL = 1000;
/** Seconds after which an answer is no longer waited for. */
const PATIENCE = 10;

export class Model {
  /** null until the hub has told it. */
  readonly graph: Signal<Graph | null>;
  readonly rates: Signal<Rates>;
  readonly clients: Signal<ClientStatistics[]>;
  /** What nodes say on /rosout. */
  readonly log: Log;

  readonly #hub: Hub;
  readonly #graph = new Source<Graph | null>(null);
  readonly #rates = new Source<Rates>(NO_RATES);
  readonly #clients = new Source<ClientStatistics[]>([]);
  readonly #types = new Map<string, Promise<TypeDef[]>>();
  /** null until this connection has had its first answer. */
  #meter: Meter | null = null;
  #timer: number | undefined;
  #asking = false;

  constructor(hub: Hub) {
    this.#hub = hub;
    this.graph = this.#graph;
    this.rates = this.#rates;
    this.clients = this.#clients;
    this.log = new Log(hub);
    hub.state.watch(() => this.#ask());
    document.addEventListener("visibilitychange", () => this.#ask());
  }

  /** The definition of a message's type and of those in it, its own first. */
  typedefs(type: string): Promise<TypeDef[]> {
    return this.#details("message_details", "MessageDetails", type);
  }

  requestTypedefs(type: string): Promise<TypeDef[]> {
    return this.#details("service_request_details", "ServiceRequestDetails", type);
  }

  responseTypedefs(type: string): Promise<TypeDef[]> {
    return this.#details("service_response_details", "ServiceResponseDetails", type);
  }

  #details(service: string, serviceType: string, type: string): Promise<TypeDef[]> {
    const key = `${service} ${type}`;
    let kept = this.#types.get(key);
    if (kept === undefined) {
      kept = this.#hub
        .call<{ typedefs: TypeDef[] }>(`/rosapi/${service}`, `rosapi/${serviceType}`, { type })
        .then(({ typedefs }) => typedefs);
      this.#types.set(key, kept);
      // A type that is unknown now may be known later.
      kept.catch(() => this.#types.delete(key));
    }
    return kept;
  }

  /** Ask now, and then again and again while there is somebody to see it. */
  #ask(): void {
    window.clearTimeout(this.#timer);
    if (this.#asking || this.#hub.state.value !== "open" || document.hidden) {
      if (this.#hub.state.value !== "open") this.#forget();
      return;
    }
    this.#asking = true;
    this.#update()
      .catch((error: unknown) => {
        // The hub itself answers these at once: if it does not, the connection is dead.
        if (error instanceof NoAnswer) this.#hub.drop("it does not answer");
        else console.debug(error);
      })
      .finally(() => {
        this.#asking = false;
        window.clearTimeout(this.#timer);
        this.#timer = window.setTimeout(() => this.#ask(), INTERVAL);
      });
  }

  async #update(): Promise<void> {
    const hub = this.#hub;
    const statistics = await hub.call<Statistics>(
      "/rosapi/statistics",
      "fibws_msgs/GetStatistics",
      {},
      PATIENCE,
    );
    if (this.#graph.value?.revision !== statistics.revision || this.#meter === null) {
      this.#graph.set(await hub.call<Graph>("/rosapi/graph", "fibws_msgs/GetGraph", {}, PATIENCE));
    }
    this.#meter ??= new Meter();
    this.#rates.set(this.#meter.rates(statistics));
    this.#clients.set(statistics.clients);
  }

  /** A hub that comes back counts anew; the graph stays in sight until then. */
  #forget(): void {
    this.#meter = null;
    this.#types.clear();
    this.#rates.set(NO_RATES);
  }
}
