import { describe, expect, it, test } from "vitest";
import {
  agoText,
  axisText,
  clock,
  contains,
  extentOf,
  linearAxis,
  logarithmicAxis,
  multiples,
  NOTHING,
  spanFor,
  ticksIn,
  timeStep,
  union,
} from "./axes";

test("extents leave out what is not finite", () => {
  expect(extentOf([3, NaN, -1, Infinity])).toEqual([-1, 3]);
  expect(extentOf([NaN])).toEqual(NOTHING);
  expect(union([[0, 1], NOTHING, [-5, 0]])).toEqual([-5, 1]);
  expect(contains([0, 1], [0, 1])).toBe(true);
  expect(contains([0, 1], [0, 1.1])).toBe(false);
  expect(contains([0, 1], NOTHING)).toBe(true);
});

describe("linear axes", () => {
  it.each([
    [
      [-1, 1],
      [-1, -0.5, 0, 0.5, 1],
    ],
    [
      [0, 1.1],
      [0, 0.3, 0.6, 0.9, 1.2],
    ],
    [
      [98, 103],
      [97.5, 99, 100.5, 102, 103.5],
    ],
    [
      [0.1, 0.3],
      [0.1, 0.15, 0.2, 0.25, 0.3],
    ],
    [
      [4, 4],
      [2, 3, 4, 5, 6],
    ],
    [
      [0, 0],
      [-1, -0.5, 0, 0.5, 1],
    ],
    [NOTHING, [0, 0.25, 0.5, 0.75, 1]],
  ] as const)("for values of %j have ticks at %j", (values, ticks) => {
    const axis = linearAxis(values, 4);
    expect(axis.ticks).toEqual(ticks);
    expect(axis.extent).toEqual([ticks[0], ticks[4]]);
  });

  it("contain their values, also tiny and huge ones", () => {
    for (const values of [
      [1e-300, 2e-300],
      [-1e300, 1e300],
      [1e12, 1e12 + 1],
      [-7.3, -7.1],
    ]) {
      const axis = linearAxis(values as [number, number], 4);
      expect(contains(axis.extent, values as [number, number])).toBe(true);
      expect(axis.ticks).toHaveLength(5);
    }
  });
});

test("logarithmic axes extend to powers of ten, with ticks between them if there is room", () => {
  expect(logarithmicAxis([3, 98], 6)).toEqual({
    extent: [1, 100],
    ticks: [1, 2, 5, 10, 20, 50, 100],
  });
  expect(logarithmicAxis([1, 10_000], 4).ticks).toEqual([1, 10, 100, 1000, 10_000]);
  expect(logarithmicAxis([1, 1e10], 5).ticks).toEqual([1, 1e2, 1e4, 1e6, 1e8, 1e10]);
  expect(logarithmicAxis([10, 10], 3).extent).toEqual([10, 100]);
  expect(logarithmicAxis(NOTHING, 3).extent).toEqual([1, 10]);
});

test("the time axis grows in steps", () => {
  expect([0, 2.1, 9, 11, 500].map((age) => spanFor(age, 30))).toEqual([2, 5, 10, 20, 30]);
  expect(spanFor(301, 600)).toBe(600);
});

test("labels of the time axis have room", () => {
  expect(timeStep(30, 10)).toBe(5);
  expect(timeStep(600, 4)).toBe(300);
  expect([timeStep(0.01, 5), timeStep(7200, 3)]).toEqual([0.002, 3600]);
  expect([0, 5, 90, 120].map(agoText)).toEqual(["now", "−5 s", "−90 s", "−2 min"]);
  expect([0.5, 0.1 + 0.2, -1e-12].map(agoText)).toEqual(["−0.5 s", "−0.3 s", "now"]);
});

test("any part of an axis has round ticks", () => {
  expect(ticksIn([0.13, 0.52], 4)).toEqual([0.2, 0.3, 0.4, 0.5]);
  expect(ticksIn([-7, 7], 3)).toEqual([-5, 0, 5]);
  expect(ticksIn([3, 700], 4, true)).toEqual([10, 100]);
  expect(ticksIn([3, 4], 5, true)).toEqual([3, 3.2, 3.4, 3.6, 3.8, 4]);
  expect(multiples([0, 0.3], 0.1)).toEqual([0, 0.1, 0.2, 0.3]);
  expect(multiples([0.1, 0.2], 5)).toEqual([]);
});

test("labels are short", () => {
  expect([0, 1200, 0.25, 1_800_000_000, -2e-7, 1e6].map(axisText)).toEqual([
    "0",
    "1200",
    "0.25",
    "1.8e9",
    "-2e-7",
    "1e6",
  ]);
  const secs = new Date(2026, 10, 21, 20, 35, 5).getTime() / 1000;
  expect([secs, secs + 0.5, secs + 0.96].map((each) => clock(each))).toEqual([
    "20:35:05",
    "20:35:05.5",
    "20:35:06",
  ]);
  expect([clock(secs + 0.123, 3), clock(secs + 0.1, 3), clock(secs, 3)]).toEqual([
    "20:35:05.123",
    "20:35:05.1",
    "20:35:05",
  ]);
});
