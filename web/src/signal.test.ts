import { expect, test } from "vitest";

import { Source } from "./signal";

test("whoever watches is told the value at once, and each change", () => {
  const source = new Source(1);
  const heard: number[] = [];
  source.watch((value) => heard.push(value));
  source.set(2);
  source.set(2);
  source.set(3);
  expect(heard).toEqual([1, 2, 3]);
});

test("whoever has left is told no more, not even by a change that is being told", () => {
  const source = new Source(0);
  const heard: string[] = [];
  source.watch((value) => {
    if (value === 1) stop();
    heard.push(`first ${value}`);
  });
  const stop = source.watch((value) => heard.push(`second ${value}`));
  source.set(1);
  expect(heard).toEqual(["first 0", "second 0", "first 1"]);
});

test("one function may watch twice, and leave once", () => {
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
