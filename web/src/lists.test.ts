import { expect, it } from "vitest";
import { append, greatest, least } from "./lists";

it.each([
  [[], Infinity, -Infinity],
  [[3, 1, 2], 1, 3],
  [[1, Number.NaN], Number.NaN, Number.NaN],
])("of %j, the least is %d and the greatest %d", (numbers, low, high) => {
  expect([least(numbers), greatest(numbers)]).toEqual([low, high]);
});

it("takes lists that no stack has room for", () => {
  const many = new Float64Array(1_000_000).fill(1);
  const list: number[] = [];
  append(list, many);
  expect([list.length, least(many), greatest(many, 5)]).toEqual([1_000_000, 1, 5]);
});
