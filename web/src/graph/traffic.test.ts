import { expect, test } from "vitest";

import { NO_RATES } from "../rates";
import { Traffic } from "./traffic";

const rates = (messages: number) => ({
  ...NO_RATES,
  publishers: new Map([["/scan /driver", { messages, bytes: 0, dropped: 0 }]]),
});

test("a flow is busy for half a minute after its latest messages", () => {
  const traffic = new Traffic();
  expect(traffic.record(rates(0), 0)).toBe(false);
  expect(traffic.isBusy("/scan /driver")).toBe(false);
  expect(traffic.record(rates(3), 1000)).toBe(true);
  expect(traffic.record(rates(3), 20_000)).toBe(false);
  expect(traffic.record(rates(0), 49_000)).toBe(false);
  expect(traffic.isBusy("/scan /driver")).toBe(true);
  expect(traffic.record(rates(0), 50_000)).toBe(true);
  expect(traffic.isBusy("/scan /driver")).toBe(false);
});
