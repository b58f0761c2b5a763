import { expect, it } from "vitest";

import type { Graph } from "../model";
import { facts } from "./facts";

const GRAPH: Graph = {
  revision: 1,
  nodes: [{ name: "/a", address: "127.0.0.1:1", since: { secs: 1, nsecs: 0 }, own: false }],
  topics: [
    {
      name: "/t",
      type: "",
      checked: true,
      publishers: [{ node: "/a", latch: false }],
      subscriptions: [],
    },
  ],
  services: [{ name: "/s", type: "std_srvs/Empty", node: "/a" }],
  actions: [],
};
const OTHER = { name: "/other", type: "", checked: true, publishers: [], subscriptions: [] };

it("changes with what concerns an element, and with nothing else", () => {
  for (const shown of [
    { kind: "node", name: "/a" },
    { kind: "topic", name: "/t" },
    { kind: "service", name: "/s" },
    { kind: "action", name: "/x" },
  ] as const) {
    const before = facts(GRAPH, shown);
    expect(facts({ ...GRAPH, topics: [...GRAPH.topics, OTHER] }, shown)).toEqual(before);
  }
  const heard = {
    ...OTHER,
    subscriptions: [{ node: "/a", queue_length: 0, throttle_rate: 0, compression: "none" }],
  };
  const node = { kind: "node", name: "/a" } as const;
  expect(facts({ ...GRAPH, topics: [...GRAPH.topics, heard] }, node)).not.toEqual(
    facts(GRAPH, node),
  );
});
