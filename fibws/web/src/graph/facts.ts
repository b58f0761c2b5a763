// What of the graph concerns one element, so that its details are made anew only when that changes.

import type { Graph } from "../model";
import type { Kind } from "./picture";

/** The part of the graph that an element's details tell. */
export function facts(graph: Graph, { kind, name }: { kind: Kind; name: string }): unknown {
  switch (kind) {
    case "node":
      return [
        graph.nodes.find((each) => each.name === name),
        graph.topics
          .filter(({ publishers }) => publishers.some((each) => each.node === name))
          .map((topic) => topic.name),
        graph.topics
          .filter(({ subscriptions }) => subscriptions.some((each) => each.node === name))
          .map((topic) => topic.name),
        graph.services.filter((each) => each.node === name),
        graph.actions.filter((each) => each.node === name),
      ];
    case "topic":
      return graph.topics.find((each) => each.name === name);
    case "service":
      return graph.services.find((each) => each.name === name);
    case "action":
      return [
        graph.actions.find((each) => each.name === name),
        graph.topics.filter((each) => each.name.startsWith(`${name}/`)).map((each) => each.name),
      ];
  }
}
