import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Clock } from "./clock";

beforeEach(() => vi.useFakeTimers({ now: 5000 }));
afterEach(() => vi.useRealTimers());

const PLAYBACK = { isLive: false, time: 1000, speed: 0, start: 0, end: 2000, bytes: 0 };

it("a live clock is this computer's", () => {
  expect(new Clock().now()).toBe(5000);
});

it("a paused clock stands, and one that plays goes on at its speed until the worker is silent", () => {
  const clock = new Clock();
  clock.report(PLAYBACK);
  vi.advanceTimersByTime(100);
  expect(clock.now()).toBe(1000);
  clock.report({ ...PLAYBACK, speed: 2 });
  vi.advanceTimersByTime(100);
  expect(clock.now()).toBe(1200);
  vi.advanceTimersByTime(10_000);
  expect(clock.now()).toBe(2000);
});

it("listeners hear of a jump until they stop", () => {
  const clock = new Clock();
  const heard = vi.fn();
  const stop = clock.onJump(heard);
  clock.jump();
  stop();
  clock.jump();
  expect(heard).toHaveBeenCalledOnce();
});
