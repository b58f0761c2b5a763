/** Rates per second, computed from the totals in the hub's statistics. */

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

/** A response of /rosapi/statistics: totals since each publisher, subscription or client came. */
export interface Statistics {
  revision: number;
  stamp: { secs: number; nsecs: number };
  topics: TopicStatistics[];
  clients: ClientStatistics[];
}

/** Per second. Drops are those since the last response, the rest is a mean (see `Meter`). */
export interface Flow {
  messages: number;
  bytes: number;
  dropped: number;
}

export interface Rates {
  /** By topic. */
  topics: Map<string, Flow>;
  /** By `flowKey`. */
  publishers: Map<string, Flow>;
  subscriptions: Map<string, Flow>;
  /** Totals, by `flowKey`. */
  dropped: Map<string, number>;
}

/** The key of the messages between a topic and a node. */
export const flowKey = (topic: string, node: string): string => `${topic} ${node}`;

export const NO_RATES: Rates = {
  topics: new Map(),
  publishers: new Map(),
  subscriptions: new Map(),
  dropped: new Map(),
};

/** Responses that a mean covers at most; they arrive about once a second. */
const MAX_RESPONSES = 5;
/** Messages that are enough for a rate: with fewer, one more or less would be visible. */
const ENOUGH = 20;

interface Count {
  readonly messages: number;
  readonly bytes: number;
  readonly dropped: number;
}

/** The counts in one response, by `flowKey`. */
interface Sample {
  readonly secs: number;
  readonly publishers: ReadonlyMap<string, Count>;
  readonly subscriptions: ReadonlyMap<string, Count>;
}

const NOTHING: Count = { messages: 0, bytes: 0, dropped: 0 };

/**
 * Computes rates from consecutive responses of one hub.
 *
 * Busy topics: the rate since the previous response. Slow topics would jump, depending on whether a
 * message came just before or just after a response. Their rate is a mean over several responses
 * with similar counts, rounded as far as these allow: a topic of 1 Hz shows 1 Hz.
 */
export class Meter {
  #previous: Sample[] = [];

  /** The rates as of a response; `NO_RATES` for the first one. */
  rates(statistics: Statistics): Rates {
    const latest = sampleOf(statistics);
    const all = this.#previous;
    this.#previous = [...all, latest].slice(-MAX_RESPONSES);
    if (all.length === 0) return NO_RATES;
    // The clock may have been set back.
    const previous = all.filter(({ secs }) => secs < latest.secs).reverse();
    return flows(statistics, latest, previous);
  }
}

function sampleOf({ stamp, topics }: Statistics): Sample {
  const publishers = new Map<string, Count>();
  const subscriptions = new Map<string, Count>();
  for (const each of topics) {
    for (const { node, messages, bytes } of each.publishers)
      publishers.set(flowKey(each.topic, node), { messages, bytes, dropped: 0 });
    for (const { node, messages, dropped } of each.subscriptions)
      subscriptions.set(flowKey(each.topic, node), { messages, bytes: 0, dropped });
  }
  return { secs: stamp.secs + stamp.nsecs / 1e9, publishers, subscriptions };
}

/** `previous` are the samples before the latest, newest first. */
function flows({ topics }: Statistics, latest: Sample, previous: readonly Sample[]): Rates {
  const result: Rates = {
    topics: new Map(),
    publishers: new Map(),
    subscriptions: new Map(),
    dropped: new Map(),
  };
  for (const { topic, publishers, subscriptions } of topics) {
    const whole: Flow = { messages: 0, bytes: 0, dropped: 0 };
    result.topics.set(topic, whole);
    for (const { node } of publishers) {
      const key = flowKey(topic, node);
      const flow = flowOf(key, "publishers", latest, previous);
      result.publishers.set(key, flow);
      whole.messages += flow.messages;
      whole.bytes += flow.bytes;
    }
    const size = whole.messages > 0 ? whole.bytes / whole.messages : 0;
    for (const { node, dropped } of subscriptions) {
      const key = flowKey(topic, node);
      const flow = flowOf(key, "subscriptions", latest, previous);
      // The hub counts bytes only of publishers; subscribers get messages of the same mean size.
      flow.bytes = flow.messages * size;
      result.subscriptions.set(key, flow);
      result.dropped.set(key, dropped);
      whole.dropped += flow.dropped;
    }
  }
  return result;
}

function flowOf(
  key: string,
  which: "publishers" | "subscriptions",
  latest: Sample,
  previous: readonly Sample[],
): Flow {
  const now = latest[which].get(key) ?? NOTHING;
  const flow: Flow = { messages: 0, bytes: 0, dropped: 0 };
  let after = now;
  let until = latest.secs;
  for (const [at, { secs, [which]: counts }] of previous.entries()) {
    const count = counts.get(key);
    // A node that reconnected counts from zero.
    const same = count !== undefined && count.messages <= after.messages;
    const before = same ? count : NOTHING;
    const here = after.messages - before.messages;
    if (
      at > 0 &&
      !isSimilar(now.messages - after.messages, latest.secs - until, here, until - secs)
    )
      break;
    const seconds = latest.secs - secs;
    const messages = now.messages - before.messages;
    flow.messages = messages < ENOUGH ? roundest(messages, seconds) : messages / seconds;
    flow.bytes =
      messages > 0 ? (flow.messages * Math.max(0, now.bytes - before.bytes)) / messages : 0;
    if (at === 0) flow.dropped = Math.max(0, now.dropped - before.dropped) / seconds;
    if (messages >= ENOUGH || !same) break;
    [after, until] = [before, secs];
  }
  return flow;
}

/** Whether two counts, each over some seconds, can come from one constant rate. */
function isSimilar(one: number, oneSeconds: number, other: number, otherSeconds: number): boolean {
  const apart = Math.abs(one / oneSeconds - other / otherSeconds);
  // Each may have one message too many or too few, and publishers have some jitter.
  return apart <= 1.1 * (1 / oneSeconds + 1 / otherSeconds);
}

/** A rate with the fewest digits that match the count to one message. */
function roundest(messages: number, seconds: number): number {
  const mean = messages / seconds;
  for (let digits = 1; digits < 4; digits += 1) {
    const round = Number(mean.toPrecision(digits));
    if (Math.abs(round - mean) * seconds <= 1) return round;
  }
  return mean;
}
