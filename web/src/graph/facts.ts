// What of the graph concerns one element, so that its details are made anew only when that changes.

import type { ActionInfo, Graph, NodeInfo, ServiceInfo, TopicInfo } from "../model";
import type { Kind } from "./picture";

export type Facts =
  | {
      kind: "node";
      node: NodeInfo;
      /** Names of topics. */
      publishes: string[];
      subscribes: string[];
      actions: string[];
      services: string[];
    }
  | { kind: "topic"; topic: TopicInfo }
  | { kind: "service"; service: ServiceInfo }
  /** The topics are those that carry it, if it is over topics. */
  | { kind: "action"; action: ActionInfo; topics: string[] };

/** The part of the graph that an element's details tell; none if it is not in the graph. */
export function facts(
  graph: Graph,
  { kind, name }: { kind: Kind; name: string },
): Facts | undefined {
  const named = (each: { name: string }): boolean => each.name === name;
  const its = (each: { node: string }): boolean => each.node === name;
  switch (kind) {
    case "node": {
      const node = graph.nodes.find(named);
      return (
        node && {
          kind,
          node,
          publishes: names(graph.topics.filter(({ publishers }) => publishers.some(its))),
          subscribes: names(graph.topics.filter(({ subscriptions }) => subscriptions.some(its))),
          actions: names(graph.actions.filter(its)),
          services: names(graph.services.filter(its)),
        }
      );
    }
    case "topic": {
      const topic = graph.topics.find(named);
      return topic && { kind, topic };
    }
    case "service": {
      const service = graph.services.find(named);
      return service && { kind, service };
    }
    case "action": {
      const action = graph.actions.find(named);
      const topics = action?.over_topics ? names(graph.topics) : [];
      return (
        action && { kind, action, topics: topics.filter((topic) => topic.startsWith(`${name}/`)) }
      );
    }
  }
}

const names = (all: readonly { name: string }[]): string[] => all.map(({ name }) => name);
