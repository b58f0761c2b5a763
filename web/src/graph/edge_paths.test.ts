import { expect, test } from "vitest";
import { curve, edgePath, interpolate, layersOf, separated, spreadLabels } from "./edge_paths";
import type { Box } from "./layout_types";

const box = (x: number, y: number): Box => ({ x, y, width: 80, height: 40 });

test("an edge is level where it crosses a layer", () => {
  const [a, passed, b] = [box(0, 0), box(200, 0), box(400, 0)];
  const layers = layersOf([a, passed, b], false);
  const bends = [
    { x: 40, y: 0 },
    { x: 200, y: 60 },
    { x: 360, y: 0 },
  ];
  const { points } = edgePath(bends, { x: 200, y: 60 }, [a, b], layers);
  expect(points).toEqual([
    { x: 40, y: 0 },
    { x: 160, y: 60 },
    { x: 240, y: 60 },
    { x: 360, y: 0 },
  ]);
});

test("an edge that goes back leaves and arrives from above", () => {
  const [a, b] = [box(0, 0), box(400, 0)];
  const bends = [
    { x: 360, y: -80 },
    { x: 200, y: -80 },
    { x: 40, y: -80 },
  ];
  const { points } = edgePath(bends, { x: 200, y: -80 }, [b, a], layersOf([a, b], false));
  expect(points[0]).toEqual({ x: 400, y: -20 });
  expect(points.at(-1)).toEqual({ x: 0, y: -20 });
});

test("an edge that goes back avoids the box above", () => {
  const [a, b, above] = [box(0, 0), box(400, 0), box(400, -60)];
  const bends = [
    { x: 360, y: -120 },
    { x: 200, y: -120 },
    { x: 40, y: -120 },
  ];
  const { points } = edgePath(bends, { x: 200, y: -120 }, [b, a], layersOf([a, b, above], false));
  expect(points[0]).toEqual({ x: 360, y: 0 });
});

test("labels are near the centres of their edges without overlaps", () => {
  const boxes = [box(0, 0), box(200, -10), box(200, 10)];
  const [a, b, c] = boxes as [Box, Box, Box];
  const layers = layersOf(boxes, false);
  const paths = [b, c].map((to) =>
    edgePath(
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
  spreadLabels(paths, layers, 20);
  expect(paths.map(({ label }) => label.y)).toEqual([-10, 10]);
  expect(paths.map(({ points }) => points[1]?.y)).toEqual([-10, 10]);
});

test("numbers are moved apart as little as possible", () => {
  expect(separated([0, 100], 10)).toEqual([0, 100]);
  expect(separated([50, 50], 10)).toEqual([45, 55]);
  expect(separated([0, 4, 100], 10)).toEqual([-3, 7, 100]);
  expect(separated([], 10)).toEqual([]);
});

test("ends a line before its head, on both ends where it goes both paths", () => {
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

test("paths with different numbers of points are interpolated", () => {
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
  expect(interpolate(straight, bent, 0)).toEqual([0, 30, 60, 90].map((x) => ({ x, y: 0 })));
  expect(interpolate(straight, bent, 1)).toEqual(bent);
});
