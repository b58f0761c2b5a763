/** What the list of topics says of each, which of them it shows, and in which order. */
import { matches } from "../filter";
import { isHidden } from "../hidden";
import type { Graph, Rates, TopicInfo } from "../model";
import { flowKey } from "../rates";

export interface TopicRow {
  readonly name: string;
  readonly type: string;
  readonly publishers: number;
  readonly subscribers: number;
  /** Messages a second. */
  readonly rate: number;
  /** Bytes a second. */
  readonly bandwidth: number;
  /** Messages dropped for its subscribers since these came. */
  readonly drops: number;
  /** Whether messages are dropped now. */
  readonly dropping: boolean;
}

export type Column = keyof Omit<TopicRow, "dropping">;

export interface Order {
  readonly column: Column;
  readonly descending: boolean;
}

export function topicRow(topic: TopicInfo, rates: Rates): TopicRow {
  const flow = rates.topics.get(topic.name);
  const drops = topic.subscriptions.reduce(
    (sum, { node }) => sum + (rates.dropped.get(flowKey(topic.name, node)) ?? 0),
    0,
  );
  return {
    name: topic.name,
    type: topic.type,
    publishers: topic.publishers.length,
    subscribers: topic.subscriptions.length,
    rate: flow?.messages ?? 0,
    bandwidth: flow?.bytes ?? 0,
    drops,
    dropping: (flow?.dropped ?? 0) > 0,
  };
}

/** The rows that all words of a text are in, by name or type. */
export function topicRows(
  graph: Graph,
  rates: Rates,
  text: string,
  debug: boolean,
  order: Order,
): TopicRow[] {
  return graph.topics
    .filter(({ name, type }) => (debug || !isHidden(name)) && matches(text, name, type))
    .map((topic) => topicRow(topic, rates))
    .sort((one, other) => compare(one, other, order));
}

function compare(one: TopicRow, other: TopicRow, { column, descending }: Order): number {
  const [a, b] = [one[column], other[column]];
  const direction = descending ? -1 : 1;
  if (a !== b) return a < b ? -direction : direction;
  return one.name < other.name ? -1 : 1;
}
