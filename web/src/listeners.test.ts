import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { Listeners } from "./listeners";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

/** Say the numbers from 0 on, one each `interval` ms. */
function count(listeners: Listeners<string>, upTo: number, interval: number): void {
  for (let n = 0; n < upTo; n += 1) {
    listeners.tell({ n });
    vi.advanceTimersByTime(interval);
  }
}

test("each hears all that comes if they want the same rate", () => {
  const listeners = new Listeners<string>();
  const [one, other] = [vi.fn(), vi.fn()];
  listeners.add("1", "", 100, one);
  listeners.add("2", "", 100, other);
  count(listeners, 5, 95);
  expect(one).toHaveBeenCalledTimes(5);
  expect(other).toHaveBeenCalledTimes(5);
});

test("who wants fewer hears fewer, and the newest at the end", () => {
  const listeners = new Listeners<string>();
  const heard: unknown[] = [];
  listeners.add("fast", "", 0, () => undefined);
  listeners.add("slow", "", 100, ({ n }) => heard.push(n));
  count(listeners, 25, 10);
  vi.advanceTimersByTime(1000);
  expect(heard).toEqual([0, 9, 19, 24]);
});

test("who has left hears nothing, not even what was kept for it", () => {
  const listeners = new Listeners<string>();
  const slow = vi.fn();
  listeners.add("fast", "", 0, () => undefined);
  listeners.add("slow", "", 100, slow);
  count(listeners, 3, 10);
  expect(listeners.remove("slow")).toBe(true);
  expect(listeners.remove("slow")).toBe(false);
  vi.advanceTimersByTime(1000);
  expect(slow).toHaveBeenCalledTimes(1);
  expect(listeners.empty).toBe(false);
});

test("the operations can be said again", () => {
  const listeners = new Listeners<string>();
  listeners.add("1", "subscribe one", 0, () => undefined);
  listeners.add("2", "subscribe two", 0, () => undefined);
  listeners.remove("1");
  expect(listeners.operations()).toEqual(["subscribe two"]);
});

test("what is latched is heard once by each, whoever comes", () => {
  const listeners = new Listeners<string>();
  const heard: [string, unknown][] = [];
  listeners.add("1", "", 0, ({ data }) => heard.push(["1", data]));
  listeners.tell({ data: 8 });
  listeners.add("2", "", 0, ({ data }) => heard.push(["2", data]));
  listeners.tell({ data: 8 });
  listeners.tell({ data: 8 });
  expect(heard).toEqual([
    ["1", 8],
    ["2", 8],
    ["1", 8],
    ["2", 8],
  ]);
});

test("what is new is heard by all, whoever came last", () => {
  const listeners = new Listeners<string>();
  const [one, other] = [vi.fn(), vi.fn()];
  listeners.add("1", "", 0, one);
  listeners.tell({ data: 8 });
  listeners.add("2", "", 0, other);
  listeners.tell({ data: 13 });
  expect(one).toHaveBeenCalledTimes(2);
  expect(other).toHaveBeenCalledTimes(1);
});
