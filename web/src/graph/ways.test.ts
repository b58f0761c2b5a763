import { expect, it } from "vitest";

import type { Box } from "./places";
import { between, curve, inRow, layersOf, spread, way } from "./ways";

const box = (x: number, y: number): Box => ({ x, y, width: 80, height: 40 });

it("keeps an arrow level where it passes a layer of boxes", () => {
  const [a, passed, b] = [box(0, 0), box(200, 0), box(400, 0)];
  const layers = layersOf([a, passed, b], false);
  const bends = [
    { x: 40, y: 0 },
    { x: 200, y: 60 },
    { x: 360, y: 0 },
  ];
  const { points } = way(bends, { x: 200, y: 60 }, [a, b], layers);
  expect(points).toEqual([
    { x: 40, y: 0 },
    { x: 160, y: 60 },
    { x: 240, y: 60 },
    { x: 360, y: 0 },
  ]);
});

it("lets an arrow that goes back leave and arrive from above", () => {
  const [a, b] = [box(0, 0), box(400, 0)];
  const bends = [
    { x: 360, y: -80 },
    { x: 200, y: -80 },
    { x: 40, y: -80 },
  ];
  const { points } = way(bends, { x: 200, y: -80 }, [b, a], layersOf([a, b], false));
  expect(points[0]).toEqual({ x: 400, y: -20 });
  expect(points.at(-1)).toEqual({ x: 0, y: -20 });
});

it("does not lead an arrow that goes back through the box above", () => {
  const [a, b, above] = [box(0, 0), box(400, 0), box(400, -60)];
  const bends = [
    { x: 360, y: -120 },
    { x: 200, y: -120 },
    { x: 40, y: -120 },
  ];
  const { points } = way(bends, { x: 200, y: -120 }, [b, a], layersOf([a, b, above], false));
  expect(points[0]).toEqual({ x: 360, y: 0 });
});

it("puts words halfway of their arrows, but not on each other", () => {
  const boxes = [box(0, 0), box(200, -10), box(200, 10)];
  const [a, b, c] = boxes as [Box, Box, Box];
  const layers = layersOf(boxes, false);
  const ways = [b, c].map((to) =>
    way(
      [
        { x: 40, y: 0 },
        { x: 100, y: 90 },
        { x: 160, y: 0 },
      ],
      { x: 100, y: 90 },
      [a, to],
      layers,
    ),
  );
  spread(ways, layers, 20);
  expect(ways.map(({ label }) => label.y)).toEqual([-10, 10]);
  expect(ways.map(({ points }) => points[1]?.y)).toEqual([-10, 10]);
});

it("keeps numbers apart and moves them as little as it takes", () => {
  expect(inRow([0, 100], 10)).toEqual([0, 100]);
  expect(inRow([50, 50], 10)).toEqual([45, 55]);
  expect(inRow([0, 4, 100], 10)).toEqual([-3, 7, 100]);
  expect(inRow([], 10)).toEqual([]);
});

it("ends a line before its head, on both ends where it goes both ways", () => {
  const points = [
    { x: 40, y: 0 },
    { x: 160, y: 0 },
  ];
  const one = curve(
    points,
    [
      { x: 0, y: 0 },
      { x: 200, y: 0 },
    ],
    false,
    false,
  );
  expect(one.line.startsWith("M40.0,0.0")).toBe(true);
  expect(one.line.endsWith("153.0,0.0")).toBe(true);
  expect(one.heads.match(/M/g)).toHaveLength(1);
  const both = curve(
    points,
    [
      { x: 0, y: 0 },
      { x: 200, y: 0 },
    ],
    false,
    true,
  );
  expect(both.line.startsWith("M47.0,0.0")).toBe(true);
  expect(both.heads.match(/M/g)).toHaveLength(2);
});

it("turns a course into one with another number of bends without leaving it", () => {
  const straight = [
    { x: 0, y: 0 },
    { x: 90, y: 0 },
  ];
  const bent = [
    { x: 0, y: 0 },
    { x: 30, y: 30 },
    { x: 60, y: 30 },
    { x: 90, y: 0 },
  ];
  expect(between(straight, bent, 0)).toEqual([0, 30, 60, 90].map((x) => ({ x, y: 0 })));
  expect(between(straight, bent, 1)).toEqual(bent);
});
