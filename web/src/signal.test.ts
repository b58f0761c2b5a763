import { expect, test } from "vitest";

import { Source } from "./signal";

test("a listener receives the value at once, and each change", () => {
  const source = new Source(1);
  const received: number[] = [];
  source.watch((value) => received.push(value));
  source.set(2);
  source.set(2);
  source.set(3);
  expect(received).toEqual([1, 2, 3]);
});

test("a removed listener receives nothing more, not even a change under way", () => {
  const source = new Source(0);
  const received: string[] = [];
  source.watch((value) => {
    if (value === 1) stop();
    received.push(`first ${value}`);
  });
  const stop = source.watch((value) => received.push(`second ${value}`));
  source.set(1);
  expect(received).toEqual(["first 0", "second 0", "first 1"]);
});

test("a function that watches twice can stop once", () => {
  const source = new Source(0);
  let calls = 0;
  const count = () => {
    calls += 1;
  };
  source.watch(count);
  const stop = source.watch(count);
  stop();
  source.set(1);
  expect(calls).toBe(3);
});
