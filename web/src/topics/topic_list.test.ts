import { describe, expect, it } from "vitest";
import { Filter } from "../filter";
import type { Graph, Rates } from "../model";
import { type Column, topicRows } from "./topic_list";

const GRAPH: Graph = {
  revision: 1,
  nodes: [],
  services: [],
  actions: [],
  topics: ["/chatter", "/rosout", "/scan", "/cmd_vel"].map((name, at) => ({
    name,
    type: name === "/chatter" ? "std_msgs/String" : "a/B",
    checked: true,
    publishers: Array.from({ length: at }, (_, each) => ({ node: `/n${each}`, latch: false })),
    subscriptions: [{ node: "/listener", queue_length: 0, throttle_rate: 0, compression: "none" }],
    conflicts: [],
  })),
};
const RATES: Rates = {
  topics: new Map([
    ["/scan", { messages: 40, bytes: 1000, dropped: 1 }],
    ["/chatter", { messages: 1, bytes: 20, dropped: 0 }],
  ]),
  publishers: new Map(),
  subscriptions: new Map(),
  dropped: new Map([["/scan /listener", 7]]),
};

function names(text: string, debug: boolean, column: Column, descending = false): string[] {
  return topicRows(GRAPH, RATES, new Filter(text), debug, { column, descending }).map(
    ({ name }) => name,
  );
}

describe("the list of topics", () => {
  it("is sorted by any column, and then by name", () => {
    expect(names("", false, "name")).toEqual(["/chatter", "/cmd_vel", "/scan"]);
    expect(names("", false, "name", true)).toEqual(["/scan", "/cmd_vel", "/chatter"]);
    expect(names("", false, "rate", true)).toEqual(["/scan", "/chatter", "/cmd_vel"]);
    expect(names("", false, "subscribers", true)).toEqual(["/chatter", "/cmd_vel", "/scan"]);
  });

  it("shows the hub's own topics only for debugging", () => {
    expect(names("", true, "name")).toContain("/rosout");
  });

  it("is filtered by name and type", () => {
    expect(names("STRING", false, "name")).toEqual(["/chatter"]);
    expect(names("a/b  scan", false, "name")).toEqual(["/scan"]);
    expect(names("-scan", false, "name")).toEqual(["/chatter", "/cmd_vel"]);
  });

  it("has rates and drops", () => {
    expect(
      topicRows(GRAPH, RATES, new Filter("scan"), false, { column: "name", descending: false }),
    ).toEqual([
      {
        name: "/scan",
        type: "a/B",
        publishers: 2,
        subscribers: 1,
        rate: 40,
        bandwidth: 1000,
        drops: 7,
        dropping: true,
      },
    ]);
  });

  it("has the topics of a node that matches the filter, as the graph has", () => {
    expect(names("/n2", false, "name")).toEqual(["/cmd_vel"]);
    expect(names("/n2 -/cmd", false, "name")).toEqual([]);
    expect(names("-/n2", false, "name")).toEqual(["/chatter", "/cmd_vel", "/scan"]);
  });
});
