import { expect, it } from "vitest";

import type { Rates } from "../model";
import { flowText } from "./flow";
import type { Edge } from "./picture";

const EDGE: Edge = {
  id: "1",
  from: "topic /t",
  to: "node /n",
  publishers: [],
  subscriptions: ["/t /n"],
  label: "",
  latched: false,
  dashed: false,
  bothWays: false,
  about: "/n subscribes to /t",
};

function rates(messages: number, dropped = 0, total = 0): Rates {
  return {
    topics: new Map(),
    publishers: new Map([["/t /p", { messages, bytes: 10 * messages, dropped: 0 }]]),
    subscriptions: new Map([["/t /n", { messages, bytes: 10 * messages, dropped }]]),
    dropped: new Map([["/t /n", total]]),
  };
}

it("says the rate, and in its title what it is the rate of", () => {
  const { label, title, idle } = flowText(EDGE, rates(1));
  expect([label, title, idle]).toEqual(["1.0 Hz", "/n subscribes to /t: 1.0 Hz, 10 B/s", false]);
});

it("is silent where nothing flows", () => {
  expect(flowText(EDGE, rates(0))).toMatchObject({ label: "", idle: true, drops: false });
});

it("grows thicker slowly: by the same for ten times as much", () => {
  const width = (messages: number) => flowText(EDGE, rates(messages)).stroke;
  expect(width(10)).toBeGreaterThan(width(1));
  expect(width(1000) - width(100)).toBeCloseTo(width(100_000) - width(10_000), 1);
  expect(width(1_000_000)).toBeLessThan(7);
});

it("warns of drops by a mark and in words", () => {
  const { label, title, drops } = flowText(EDGE, rates(10, 2, 12));
  expect(label).toBe("⚠ 10.0 Hz");
  expect(title).toContain("12 dropped since it came, 2.0 Hz now");
  expect(drops).toBe(true);
  expect(flowText(EDGE, rates(10, 0, 12))).toMatchObject({ drops: false, label: "10.0 Hz" });
});

it("says that a publisher latches, with or without a rate", () => {
  const latched: Edge = { ...EDGE, publishers: ["/t /p"], subscriptions: [], latched: true };
  expect(flowText(latched, rates(0)).label).toBe("latched");
  expect(flowText(latched, rates(2)).label).toBe("2.0 Hz latched");
});

it("adds up both ways of an action", () => {
  const both: Edge = { ...EDGE, publishers: ["/t /p"], bothWays: true };
  expect(flowText(both, rates(3)).label).toBe("6.0 Hz");
});
