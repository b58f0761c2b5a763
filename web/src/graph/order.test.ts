import { expect, test } from "vitest";

import { rising } from "./order";

const sorted = (ranks: number[]): number[] => [...rising(ranks)].sort((a, b) => a - b);

test("what is in order stays", () => {
  expect(sorted([0, 1, 2, 3])).toEqual([0, 1, 2, 3]);
  expect(sorted([])).toEqual([]);
});

test("of what has come before all others, only that moves", () => {
  expect(sorted([1, 2, 3, 0])).toEqual([1, 2, 3]);
  expect(sorted([3, 0, 1, 2])).toEqual([0, 1, 2]);
});

test("the most that rise stay", () => {
  expect(sorted([5, 0, 6, 1, 2, 7, 3])).toEqual([0, 1, 2, 3]);
  expect(sorted([3, 2, 1, 0])).toHaveLength(1);
});
