import { expect, test, vi } from "vitest";

import { breakable, longestRising } from "./dom";

const sorted = (numbers: number[]): number[] => [...longestRising(numbers)].sort((a, b) => a - b);

test("all of a sorted list", () => {
  expect(sorted([0, 1, 2, 3])).toEqual([0, 1, 2, 3]);
  expect(sorted([])).toEqual([]);
});

test("all but one that was moved to the end or to the front", () => {
  expect(sorted([1, 2, 3, 0])).toEqual([1, 2, 3]);
  expect(sorted([3, 0, 1, 2])).toEqual([0, 1, 2]);
});

test("the longest of several", () => {
  expect(sorted([5, 0, 6, 1, 2, 7, 3])).toEqual([0, 1, 2, 3]);
  expect(sorted([3, 2, 1, 0])).toHaveLength(1);
});

test.each([
  ["", [""]],
  ["/scan", ["/", "scan"]],
  ["/robot_1/cmd_vel", ["/", "robot_", "1/", "cmd_", "vel"]],
  ["a__b//c_", ["a__", "b//", "c_"]],
])("a line of the name %s may end only after slashes and underscores", (name, words) => {
  vi.stubGlobal("document", { createElement: () => "|" });
  try {
    expect(breakable(name)).toEqual(words.flatMap((word, at) => (at === 0 ? [word] : ["|", word])));
  } finally {
    vi.unstubAllGlobals();
  }
});
