import { expect, test } from "vitest";

import { hertz } from "./format";
import { Meter, NO_RATES, type Rates, type Statistics, type TopicStatistics } from "./rates";

function atTime(secs: number, nsecs: number, ...topics: TopicStatistics[]): Statistics {
  return { revision: 1, stamp: { secs, nsecs }, topics, clients: [] };
}

function topic(
  messages: number,
  bytes: number,
  received: number,
  dropped: number,
): TopicStatistics {
  return {
    topic: "/t",
    publishers: [{ node: "/p", messages, bytes }],
    subscriptions: [{ node: "/s", messages: received, dropped }],
  };
}

/** The rates as of the last of some responses. */
function rates(...responses: Statistics[]): Rates {
  const meter = new Meter();
  return responses.map((response) => meter.rates(response)).at(-1) ?? NO_RATES;
}

/** The rate shown for a topic with messages at fixed times, after each response. */
function shownRates(period: number, responses: number): string[] {
  const meter = new Meter();
  return Array.from({ length: responses }, (_, at) => {
    // Each request follows the previous response, which takes some time.
    const now = 1000 + 1.013 * at;
    const messages = Math.floor(now / period);
    const [secs, nsecs] = [Math.floor(now), Math.round((now % 1) * 1e9)];
    const { topics } = meter.rates(atTime(secs, nsecs, topic(messages, 4 * messages, messages, 0)));
    return hertz(topics.get("/t")?.messages ?? 0);
  });
}

test("a rate is the difference of two totals over the time between their stamps", () => {
  const result = rates(
    atTime(10, 500_000_000, topic(100, 1000, 50, 0)),
    atTime(12, 0, topic(130, 1600, 65, 3)),
  );
  expect(result.publishers.get("/t /p")).toEqual({ messages: 20, bytes: 400, dropped: 0 });
  expect(result.subscriptions.get("/t /s")).toEqual({ messages: 10, bytes: 200, dropped: 2 });
  expect(result.topics.get("/t")).toEqual({ messages: 20, bytes: 400, dropped: 2 });
  expect(result.dropped.get("/t /s")).toBe(3);
});

test("a new topic counts from zero", () => {
  const result = rates(atTime(1, 0), atTime(2, 0, topic(5, 50, 5, 0)));
  expect(result.topics.get("/t")).toEqual({ messages: 5, bytes: 50, dropped: 0 });
});

test("a node that reconnected counts from zero", () => {
  const result = rates(atTime(1, 0, topic(100, 1000, 100, 10)), atTime(2, 0, topic(4, 40, 4, 0)));
  expect(result.topics.get("/t")).toEqual({ messages: 4, bytes: 40, dropped: 0 });
});

test.each([0, -5])("a clock that moved by %d s gives no rates", (moved) => {
  const former = atTime(10, 0, topic(1, 10, 1, 0));
  const result = rates(former, atTime(10 + moved, 0, topic(9, 90, 9, 1)));
  expect(result.topics.get("/t")).toEqual({ messages: 0, bytes: 0, dropped: 0 });
});

test("there are no rates before the second response", () => {
  expect(rates(atTime(1, 0, topic(5, 50, 5, 0)))).toBe(NO_RATES);
});

test.each([
  [1, ["1.0 Hz"]],
  [2, ["0.40 Hz", "0.60 Hz"]],
  [5, ["0.20 Hz", "0.40 Hz"]],
])("the rate of a topic with a message every %d s is steady", (period, texts) => {
  expect(new Set(shownRates(period, 300).slice(6))).toEqual(new Set(texts));
});

test.each([1000, 15, 3])(
  "a topic of %d Hz that starts or stops shows that with the next response",
  (n) => {
    const totals = [0, 0, 0, n, 2 * n, 3 * n, 3 * n, 3 * n];
    const meter = new Meter();
    const flows = totals.map((total, at) =>
      meter.rates(atTime(at, 0, topic(total, 4 * total, 0, 0))).topics.get("/t"),
    );
    expect(flows.slice(1).map((flow) => flow?.messages)).toEqual([0, 0, n, n, n, 0, 0]);
    expect(flows[3]?.bytes).toBe(4 * n);
  },
);

test("drops are those since the last response", () => {
  const result = rates(
    atTime(1, 0, topic(1, 4, 1, 0)),
    atTime(2, 0, topic(2, 8, 1, 5)),
    atTime(3, 0, topic(3, 12, 1, 5)),
  );
  expect(result.topics.get("/t")?.dropped).toBe(0);
});
