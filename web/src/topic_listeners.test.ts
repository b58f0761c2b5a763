import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { TopicListeners } from "./topic_listeners";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

/** Dispatch the numbers from 0 on, one each `interval` ms. */
function count(listeners: TopicListeners<string>, upTo: number, interval: number): void {
  for (let n = 0; n < upTo; n += 1) {
    listeners.dispatch({ n });
    vi.advanceTimersByTime(interval);
  }
}

test("listeners of the same rate receive every message", () => {
  const listeners = new TopicListeners<string>();
  const [one, other] = [vi.fn(), vi.fn()];
  listeners.add("1", "", 100, one);
  listeners.add("2", "", 100, other);
  count(listeners, 5, 95);
  expect(one).toHaveBeenCalledTimes(5);
  expect(other).toHaveBeenCalledTimes(5);
});

test("a slower listener receives fewer messages, and the newest at the end", () => {
  const listeners = new TopicListeners<string>();
  const received: unknown[] = [];
  listeners.add("fast", "", 0, () => undefined);
  listeners.add("slow", "", 100, ({ n }) => received.push(n));
  count(listeners, 25, 10);
  vi.advanceTimersByTime(1000);
  expect(received).toEqual([0, 9, 19, 24]);
});

test("a removed listener receives nothing, not even its delayed message", () => {
  const listeners = new TopicListeners<string>();
  const slow = vi.fn();
  listeners.add("fast", "", 0, () => undefined);
  listeners.add("slow", "", 100, slow);
  count(listeners, 3, 10);
  expect(listeners.remove("slow")).toBe(true);
  expect(listeners.remove("slow")).toBe(false);
  vi.advanceTimersByTime(1000);
  expect(slow).toHaveBeenCalledTimes(1);
  expect(listeners.isEmpty).toBe(false);
});

test("the operations of the current listeners are returned", () => {
  const listeners = new TopicListeners<string>();
  listeners.add("1", "subscribe one", 0, () => undefined);
  listeners.add("2", "subscribe two", 0, () => undefined);
  listeners.remove("1");
  expect(listeners.operations()).toEqual(["subscribe two"]);
});

test("a latched message is received once by each listener", () => {
  const listeners = new TopicListeners<string>();
  const received: [string, unknown][] = [];
  listeners.add("1", "", 0, ({ data }) => received.push(["1", data]));
  listeners.dispatch({ data: 8 });
  listeners.add("2", "", 0, ({ data }) => received.push(["2", data]));
  listeners.dispatch({ data: 8 });
  listeners.dispatch({ data: 8 });
  expect(received).toEqual([
    ["1", 8],
    ["2", 8],
    ["1", 8],
    ["2", 8],
  ]);
});

test("a new message is received by all listeners", () => {
  const listeners = new TopicListeners<string>();
  const [one, other] = [vi.fn(), vi.fn()];
  listeners.add("1", "", 0, one);
  listeners.dispatch({ data: 8 });
  listeners.add("2", "", 0, other);
  listeners.dispatch({ data: 13 });
  expect(one).toHaveBeenCalledTimes(2);
  expect(other).toHaveBeenCalledTimes(1);
});
