/** The graph and its rates, polled from the hub. */
import { Log } from "./console/log";
import { CallTimeout, type Hub } from "./hub";
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
  /** IP address and port; empty for the hub's own nodes. */
  address: string;
  since: Time;
  /** Whether it is part of the hub. */
  own: boolean;
  /** The URI at which a ROS 1 node answers calls; empty for nodes that are connected to the hub. */
  api: string;
  /** Why a ROS 1 node does not answer; empty while it does. */
  fault: string;
  /** The name of the other hub that it is connected to; empty for nodes of this hub. */
  hub: string;
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

/** A ROS 1 node that uses a topic, and cannot exchange messages with the hub's clients there. */
export interface ConflictInfo {
  node: string;
  /** The type with which it uses the topic. */
  type: string;
  /** Whether it publishes; else it subscribes. */
  publishes: boolean;
  fault: string;
  /** Of the type, if the topic has another type of the same name; else empty. */
  md5sum: string;
}

export interface TopicInfo {
  name: string;
  /** Empty if it is unknown so far. */
  type: string;
  checked: boolean;
  publishers: PublisherInfo[];
  subscriptions: SubscriptionInfo[];
  conflicts: ConflictInfo[];
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
  /** Whether it uses topics, as in ROS 1; else the operations of ROS 2. */
  over_topics: boolean;
}

export interface Graph {
  revision: number;
  nodes: NodeInfo[];
  topics: TopicInfo[];
  services: ServiceInfo[];
  actions: ActionInfo[];
}

/** What there is, and how it flows. */
export type Model = Pick<HubModel, keyof HubModel>;

/** Time from a response to the next request, in ms. */
const INTERVAL = 1000;
/** Seconds until a request times out. */
const TIMEOUT = 10;

export class HubModel {
  /** null until the first response. */
  readonly graph: Signal<Graph | null>;
  readonly rates: Signal<Rates>;
  readonly clients: Signal<ClientStatistics[]>;
  /** The messages on /rosout. */
  readonly log: Log;

  readonly #hub: Hub;
  readonly #graph = new Source<Graph | null>(null);
  readonly #rates = new Source<Rates>(NO_RATES);
  readonly #clients = new Source<ClientStatistics[]>([]);
  readonly #types = new Map<string, Promise<TypeDef[]>>();
  /** null until the first response on this connection. */
  #meter: Meter | null = null;
  #timer: number | undefined;
  #requesting = false;

  constructor(hub: Hub) {
    this.#hub = hub;
    this.graph = this.#graph;
    this.rates = this.#rates;
    this.clients = this.#clients;
    this.log = new Log(hub);
    hub.state.watch(() => this.#poll());
    document.addEventListener("visibilitychange", () => this.#poll());
  }

  /** The definitions of a message type, which comes first, and of the types in it. */
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
    let cached = this.#types.get(key);
    if (cached === undefined) {
      cached = this.#hub
        .call<{ typedefs: TypeDef[] }>(`/rosapi/${service}`, `rosapi/${serviceType}`, { type })
        .then(({ typedefs }) => typedefs);
      this.#types.set(key, cached);
      // An unknown type may be known later.
      cached.catch(() => this.#types.delete(key));
    }
    return cached;
  }

  /** Request the statistics now, and periodically while the page is visible and connected. */
  #poll(): void {
    window.clearTimeout(this.#timer);
    if (this.#requesting || this.#hub.state.value !== "open" || document.hidden) {
      if (this.#hub.state.value !== "open") this.#reset();
      return;
    }
    this.#requesting = true;
    this.#update()
      .catch((error: unknown) => {
        // The hub responds to these at once, unless the connection is dead.
        if (error instanceof CallTimeout) this.#hub.drop("no response");
        else console.debug(error);
      })
      .finally(() => {
        this.#requesting = false;
        window.clearTimeout(this.#timer);
        this.#timer = window.setTimeout(() => this.#poll(), INTERVAL);
      });
  }

  async #update(): Promise<void> {
    const hub = this.#hub;
    const statistics = await hub.call<Statistics>(
      "/rosapi/statistics",
      "fibws_msgs/GetStatistics",
      {},
      TIMEOUT,
    );
    if (this.#graph.value?.revision !== statistics.revision || this.#meter === null) {
      this.#graph.set(await hub.call<Graph>("/rosapi/graph", "fibws_msgs/GetGraph", {}, TIMEOUT));
    }
    this.#meter ??= new Meter();
    this.#rates.set(this.#meter.rates(statistics));
    this.#clients.set(statistics.clients);
  }

  /** A restarted hub counts from zero. The graph stays until the hub responds. */
  #reset(): void {
    this.#meter = null;
    this.#types.clear();
    this.#rates.set(NO_RATES);
  }
}
