import { expect, test } from "vitest";

import { type Statistics, type TopicStatistics, rates } from "./rates";

function at(secs: number, nsecs: number, ...topics: TopicStatistics[]): Statistics {
  return { revision: 1, stamp: { secs, nsecs }, topics, clients: [] };
}

function topic(messages: number, bytes: number, heard: number, dropped: number): TopicStatistics {
  return {
    topic: "/t",
    publishers: [{ node: "/p", messages, bytes }],
    subscriptions: [{ node: "/s", messages: heard, dropped }],
  };
}

test("a rate is the difference of two totals over the time between their stamps", () => {
  const result = rates(
    at(10, 500_000_000, topic(100, 1000, 50, 0)),
    at(12, 0, topic(130, 1600, 65, 3)),
  );
  expect(result.publishers.get("/t /p")).toEqual({ messages: 20, bytes: 400, dropped: 0 });
  expect(result.subscriptions.get("/t /s")).toEqual({ messages: 10, bytes: 200, dropped: 2 });
  expect(result.topics.get("/t")).toEqual({ messages: 20, bytes: 400, dropped: 2 });
  expect(result.dropped.get("/t /s")).toBe(3);
});

test("what was not there before has all of its total from since then", () => {
  const result = rates(at(1, 0), at(2, 0, topic(5, 50, 5, 0)));
  expect(result.topics.get("/t")).toEqual({ messages: 5, bytes: 50, dropped: 0 });
});

test("who left and came back in between counts from nothing", () => {
  const result = rates(at(1, 0, topic(100, 1000, 100, 10)), at(2, 0, topic(4, 40, 4, 0)));
  expect(result.topics.get("/t")).toEqual({ messages: 4, bytes: 40, dropped: 0 });
});

test.each([0, -5])("a clock that moved by %d s gives no rates", (moved) => {
  const result = rates(at(10, 0, topic(1, 10, 1, 0)), at(10 + moved, 0, topic(9, 90, 9, 1)));
  expect(result.topics.get("/t")).toEqual({ messages: 0, bytes: 0, dropped: 0 });
});
