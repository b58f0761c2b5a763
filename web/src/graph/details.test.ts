import { expect, it } from "vitest";

import type { Graph } from "../model";
import { elementData } from "./details";

const GRAPH: Graph = {
  revision: 1,
  nodes: [
    {
      name: "/a",
      address: "127.0.0.1:1",
      since: { secs: 1, nsecs: 0 },
      own: false,
      api: "",
      fault: "",
      hub: "",
    },
  ],
  topics: [
    {
      name: "/t",
      type: "",
      checked: true,
      publishers: [{ node: "/a", latch: false }],
      subscriptions: [],
      conflicts: [],
    },
  ],
  services: [{ name: "/s", type: "std_srvs/Empty", node: "/a" }],
  actions: [],
};
const OTHER = {
  name: "/other",
  type: "",
  checked: true,
  publishers: [],
  subscriptions: [],
  conflicts: [],
};

it("the data of an element changes only with the element", () => {
  for (const shown of [
    { kind: "node", name: "/a" },
    { kind: "topic", name: "/t" },
    { kind: "service", name: "/s" },
    { kind: "action", name: "/x" },
  ] as const) {
    const before = elementData(GRAPH, shown);
    expect(elementData({ ...GRAPH, topics: [...GRAPH.topics, OTHER] }, shown)).toEqual(before);
  }
  const subscribed = {
    ...OTHER,
    subscriptions: [{ node: "/a", queue_length: 0, throttle_rate: 0, compression: "none" }],
  };
  const node = { kind: "node", name: "/a" } as const;
  expect(elementData({ ...GRAPH, topics: [...GRAPH.topics, subscribed] }, node)).not.toEqual(
    elementData(GRAPH, node),
  );
});

it("the details of a node and of its topic have the type conflict between them", () => {
  const conflict = { node: "/a", type: "b/C", publishes: false, fault: "why", md5sum: "" };
  const topic = { ...OTHER, type: "a/B", conflicts: [conflict] };
  const graph = { ...GRAPH, topics: [topic] };
  expect(elementData(graph, { kind: "node", name: "/a" })).toMatchObject({
    conflicts: [{ topic: "/other", text: "subscribes to b/C, the topic is a/B" }],
  });
  expect(elementData(graph, { kind: "topic", name: "/other" })).toMatchObject({
    topic: { conflicts: [conflict] },
  });
});
