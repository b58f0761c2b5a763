/** From totals to what flows in a second. */

export interface PublisherStatistics {
  node: string;
  messages: number;
  bytes: number;
}

export interface SubscriptionStatistics {
  node: string;
  messages: number;
  dropped: number;
}

export interface TopicStatistics {
  topic: string;
  publishers: PublisherStatistics[];
  subscriptions: SubscriptionStatistics[];
}

export interface ClientStatistics {
  node: string;
  address: string;
  kept_bytes: number;
  dropped: number;
  slow: boolean;
}

/** The totals at one time, each since its publisher, subscription or client came. */
export interface Statistics {
  revision: number;
  stamp: { secs: number; nsecs: number };
  topics: TopicStatistics[];
  clients: ClientStatistics[];
}

/** Per second. */
export interface Flow {
  messages: number;
  bytes: number;
  dropped: number;
}

export interface Rates {
  /** By topic. */
  topics: Map<string, Flow>;
  /** By topic and node, a space between. */
  publishers: Map<string, Flow>;
  subscriptions: Map<string, Flow>;
  /** Totals, by topic and node. */
  dropped: Map<string, number>;
}

export const NO_RATES: Rates = {
  topics: new Map(),
  publishers: new Map(),
  subscriptions: new Map(),
  dropped: new Map(),
};

/** What flowed between two answers, as a mean over the time between their stamps. */
export function rates(former: Statistics, latter: Statistics): Rates {
  const seconds =
    latter.stamp.secs - former.stamp.secs + (latter.stamp.nsecs - former.stamp.nsecs) / 1e9;
  const per = (now: number, before = 0): number =>
    // Who left and came back counts anew, and no clock is to be trusted to go forward.
    seconds > 0 ? Math.max(0, now < before ? now : now - before) / seconds : 0;

  const told = new Map(former.topics.map((each) => [each.topic, each]));
  const result: Rates = {
    topics: new Map(),
    publishers: new Map(),
    subscriptions: new Map(),
    dropped: new Map(),
  };
  for (const { topic, publishers, subscriptions } of latter.topics) {
    const before = told.get(topic);
    const whole: Flow = { messages: 0, bytes: 0, dropped: 0 };
    result.topics.set(topic, whole);
    for (const { node, messages, bytes } of publishers) {
      const old = before?.publishers.find((each) => each.node === node);
      const flow: Flow = {
        messages: per(messages, old?.messages),
        bytes: per(bytes, old?.bytes),
        dropped: 0,
      };
      result.publishers.set(`${topic} ${node}`, flow);
      whole.messages += flow.messages;
      whole.bytes += flow.bytes;
    }
    const size = whole.messages > 0 ? whole.bytes / whole.messages : 0;
    for (const { node, messages, dropped } of subscriptions) {
      const old = before?.subscriptions.find((each) => each.node === node);
      const heard = per(messages, old?.messages);
      // The hub counts bytes where they come in; a message's mean size tells the rest.
      const flow: Flow = {
        messages: heard,
        bytes: heard * size,
        dropped: per(dropped, old?.dropped),
      };
      result.subscriptions.set(`${topic} ${node}`, flow);
      result.dropped.set(`${topic} ${node}`, dropped);
      whole.dropped += flow.dropped;
    }
  }
  return result;
}
