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

/** Per second: drops as of the last answer, the rest as a mean over some (see `Meter`). */
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

/** The key of what flows from a node to a topic, or from there to a node. */
export const flowKey = (topic: string, node: string): string => `${topic} ${node}`;

export const NO_RATES: Rates = {
  topics: new Map(),
  publishers: new Map(),
  subscriptions: new Map(),
  dropped: new Map(),
};

/** Answers that a mean reaches back over at most; they come about once a second. */
const MOST = 5;
/** So many messages make a rate: of fewer, one more or less would be seen. */
const ENOUGH = 20;

interface Count {
  readonly messages: number;
  readonly bytes: number;
  readonly dropped: number;
}

/** What one answer said, by `flowKey`. */
interface Answer {
  readonly secs: number;
  readonly publishers: ReadonlyMap<string, Count>;
  readonly subscriptions: ReadonlyMap<string, Count>;
}

const NOTHING: Count = { messages: 0, bytes: 0, dropped: 0 };

/**
 * Makes rates of the totals that one hub tells again and again.
 *
 * Where much flows, they are those since the answer before. Where little flows, whether a message
 * came just before an answer or just after it would make them jump, so that they are a mean over
 * more answers that are alike, and as round as these allow: a topic of 1 Hz has 1 Hz.
 */
export class Meter {
  #former: Answer[] = [];

  /** The rates as of an answer; `NO_RATES` at the first. */
  rates(statistics: Statistics): Rates {
    const latest = answer(statistics);
    const all = this.#former;
    this.#former = [...all, latest].slice(-MOST);
    if (all.length === 0) return NO_RATES;
    // No clock is to be trusted to go forward.
    const former = all.filter(({ secs }) => secs < latest.secs).reverse();
    return flows(statistics, latest, former);
  }
}

function answer({ stamp, topics }: Statistics): Answer {
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

/** `former` are the answers before the latest, the newest first. */
function flows({ topics }: Statistics, latest: Answer, former: readonly Answer[]): Rates {
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
      const flow = flowOf(key, "publishers", latest, former);
      result.publishers.set(key, flow);
      whole.messages += flow.messages;
      whole.bytes += flow.bytes;
    }
    const size = whole.messages > 0 ? whole.bytes / whole.messages : 0;
    for (const { node, dropped } of subscriptions) {
      const key = flowKey(topic, node);
      const flow = flowOf(key, "subscriptions", latest, former);
      // The hub counts bytes where they come in; a message's mean size tells the rest.
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
  latest: Answer,
  former: readonly Answer[],
): Flow {
  const now = latest[which].get(key) ?? NOTHING;
  const flow: Flow = { messages: 0, bytes: 0, dropped: 0 };
  let after = now;
  let until = latest.secs;
  for (const [at, { secs, [which]: counts }] of former.entries()) {
    const told = counts.get(key);
    // Who left and came back counts anew.
    const same = told !== undefined && told.messages <= after.messages;
    const before = same ? told : NOTHING;
    const here = after.messages - before.messages;
    if (at > 0 && !alike(now.messages - after.messages, latest.secs - until, here, until - secs))
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

/** Whether one rate may have led to both of two counts, each taken over some seconds. */
function alike(one: number, oneSeconds: number, other: number, otherSeconds: number): boolean {
  const apart = Math.abs(one / oneSeconds - other / otherSeconds);
  // Each may have one message too many or too few; and nobody is quite punctual.
  return apart <= 1.1 * (1 / oneSeconds + 1 / otherSeconds);
}

/** A rate in the fewest digits that tell it to one message. */
function roundest(messages: number, seconds: number): number {
  const mean = messages / seconds;
  for (let digits = 1; digits < 4; digits += 1) {
    const round = Number(mean.toPrecision(digits));
    if (Math.abs(round - mean) * seconds <= 1) return round;
  }
  return mean;
}
