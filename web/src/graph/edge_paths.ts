/** The paths of edges between boxes, and the SVG curves that draw them. */

import type { Box, EdgePath, Point } from "./layout_types";

/** The layers of a layout, which edges cross. */
export interface Layers {
  boxes: readonly Box[];
  /** Half the depth of each layer, by the position of its centre. */
  depths: ReadonlyMap<number, number>;
  /** Whether they go from top to bottom, not from left to right. */
  down: boolean;
}

/** The length of an arrowhead. */
const HEAD = 7;
/** The least distance of an edge that goes back from the boxes. */
const CLEARANCE = 10;
const turned = ({ x, y }: Point): Point => ({ x: y, y: x });
const straight = (point: Point): Point => point;

/** The layers of some boxes: the boxes of a layer are centred on one line. */
export function layersOf(boxes: readonly Box[], down: boolean): Layers {
  const depths = new Map<number, number>();
  for (const { x, y, width, height } of boxes) {
    const middle = Math.round(down ? y : x);
    depths.set(middle, Math.max(depths.get(middle) ?? 0, (down ? height : width) / 2));
  }
  return { boxes, depths, down };
}

/**
 * The path of an edge from the side of one box to the side of another.
 *
 * It is level across the whole depth of a layer, so that it does not cut corners of boxes. An
 * edge that goes back leaves and arrives above or below, where no other edge does.
 */
export function edgePath(
  bends: readonly Point[],
  label: Point,
  [from, to]: readonly [Box, Box],
  { boxes, depths, down }: Layers,
): EdgePath {
  const turn = down ? turned : straight;
  const half = (box: Box): number => (down ? box.height : box.width) / 2;
  const [start, end] = [turn(from), turn(to)];
  const labelAt = turn(label);
  const inner = bends
    .slice(1, -1)
    .map(turn)
    .filter(({ x }) => depths.has(Math.round(x)) || Math.abs(x - labelAt.x) < 1);
  const onward = Math.sign(end.x - start.x);
  const levelled: Point[] = [];
  for (const { x, y } of inner) {
    const depth = depths.get(Math.round(x)) ?? 0;
    if (depth > 0 && onward !== 0) {
      levelled.push({ x: x - onward * depth, y }, { x: x + onward * depth, y });
    } else levelled.push({ x, y });
  }
  const side = (box: Box, at: Point, next: Point, otherwise: number): Point => {
    const off = next.y - at.y;
    const across = (down ? box.width : box.height) / 2;
    if (onward < 0 && Math.abs(off) > across + CLEARANCE && isClear(box, next, boxes, down)) {
      return { x: at.x, y: at.y + Math.sign(off) * across };
    }
    return { x: at.x + (Math.sign(next.x - at.x) || otherwise) * half(box), y: at.y };
  };
  const course = (middle: readonly Point[]): Point[] => [
    side(from, start, middle[0] ?? end, 1),
    ...middle,
    side(to, end, middle.at(-1) ?? start, -1),
  ];
  const smooth = course(levelled);
  return {
    points: (isOrdered(smooth) ? smooth : course(inner)).map(turn),
    label,
  };
}

function isOrdered(points: readonly Point[]): boolean {
  const steps = points.slice(1).map(({ x }, index) => x - (points[index] as Point).x);
  return steps.every((step) => step > 0) || steps.every((step) => step < 0);
}

/**
 * Move the labels between two layers close to the centres of their edges, without overlaps.
 *
 * This also makes the edges straighter.
 */
export function spreadLabels(
  paths: readonly EdgePath[],
  { depths, down }: Layers,
  apart: number,
): void {
  const turn = down ? turned : straight;
  const gaps = new Map<string, { path: EdgePath; middle: number }[]>();
  for (const path of paths) {
    const at = path.points.map(turn);
    const [first, labelAt, last] = at;
    if (first === undefined || labelAt === undefined || last === undefined || at.length !== 3)
      continue;
    const columns = [...depths.keys()].filter((x) => x < Math.min(first.x, last.x) + 1);
    const gap = `${columns.length} ${Math.sign(last.x - first.x)}`;
    gaps.set(gap, [...(gaps.get(gap) ?? []), { path, middle: (first.y + last.y) / 2 }]);
  }
  for (const row of gaps.values()) {
    row.sort((a, b) => a.middle - b.middle);
    const positions = separated(
      row.map(({ middle }) => middle),
      apart,
    );
    for (const [index, { path }] of row.entries()) {
      const { x } = turn(path.label);
      path.label = turn({ x, y: positions[index] as number });
      path.points[1] = path.label;
    }
  }
}

/** Move sorted numbers as little as possible so that they are `apart` from each other. */
export function separated(wanted: readonly number[], apart: number): number[] {
  const blocks: { sum: number; count: number }[] = [];
  for (const [index, each] of wanted.entries()) {
    let block = { sum: each - index * apart, count: 1 };
    for (let previous = blocks.at(-1); previous !== undefined; previous = blocks.at(-1)) {
      if (previous.sum / previous.count < block.sum / block.count) break;
      blocks.pop();
      block = { sum: previous.sum + block.sum, count: previous.count + block.count };
    }
    blocks.push(block);
  }
  return blocks
    .flatMap(({ sum, count }) => Array.from({ length: count }, () => sum / count))
    .map((each, index) => each + index * apart);
}

/** Whether no other box is between a box and the height of a point. */
function isClear(box: Box, towards: Point, boxes: readonly Box[], down: boolean): boolean {
  const turn = down ? turned : straight;
  const at = turn(box);
  return boxes.every((other) => {
    if (other === box) return true;
    const position = turn(other);
    const wide = (down ? other.height : other.width) / 2;
    const between = (position.y - at.y) * (position.y - towards.y) < 0;
    return !between || Math.abs(position.x - at.x) > wide + CLEARANCE;
  });
}

/** The SVG paths of an edge's line and arrowheads. The line is at right angles to the boxes. */
export function curve(
  points: readonly Point[],
  ends: readonly [Point, Point],
  down: boolean,
  bothWays: boolean,
): { line: string; heads: string } {
  const turn = down ? turned : straight;
  const at = points.map(turn);
  const [start, end] = ends.map(turn);
  const [first, last] = [at[0], at.at(-1)];
  if (first === undefined || last === undefined || start === undefined || end === undefined) {
    return { line: "", heads: "" };
  }
  const text = (point: Point): string => {
    const { x, y } = turn(point);
    return `${x.toFixed(1)},${y.toFixed(1)}`;
  };
  /** The direction away from the box; ends above or below its centre are those of edges back. */
  const outwards = (tip: Point, middle: Point): Point =>
    Math.abs(tip.x - middle.x) < 1
      ? { x: 0, y: Math.sign(tip.y - middle.y) }
      : { x: Math.sign(tip.x - middle.x), y: 0 };
  const head = (tip: Point, out: Point): string => {
    const back = (side: number): Point => ({
      x: tip.x + out.x * (HEAD + 1) + out.y * side,
      y: tip.y + out.y * (HEAD + 1) + out.x * side,
    });
    return `M${text(tip)}L${text(back(4))}L${text(back(-4))}Z`;
  };
  const leave = outwards(first, start);
  const arrive = outwards(last, end);
  const heads = head(last, arrive) + (bothWays ? head(first, leave) : "");
  at[at.length - 1] = { x: last.x + arrive.x * HEAD, y: last.y + arrive.y * HEAD };
  if (bothWays) at[0] = { x: first.x + leave.x * HEAD, y: first.y + leave.y * HEAD };
  return { line: smooth(at, leave.y !== 0, arrive.y !== 0, text), heads };
}

/** A smooth line through points that never overshoots them (Fritsch and Carlson). */
function smooth(
  at: readonly Point[],
  risesFirst: boolean,
  fallsLast: boolean,
  text: (point: Point) => string,
): string {
  const final = at.length - 1;
  const step = (index: number): Point => {
    const [a, b] = [at[index] as Point, at[index + 1] as Point];
    return { x: b.x - a.x, y: b.y - a.y };
  };
  const slope = (index: number): number => {
    if (index === 0 || index === final) return 0;
    if ((risesFirst && index === 1) || (fallsLast && index === final - 1)) return 0;
    const [a, b] = [step(index - 1), step(index)];
    if (a.x * b.x <= 0) return 0;
    const [before, after] = [a.y / a.x, b.y / b.x];
    if (before * after <= 0) return 0;
    const mean = (before * b.x + after * a.x) / (a.x + b.x);
    return Math.sign(mean) * Math.min(Math.abs(mean), 2 * Math.abs(before), 2 * Math.abs(after));
  };
  let line = `M${text(at[0] as Point)}`;
  for (let index = 0; index < final; index += 1) {
    const [a, b] = [at[index] as Point, at[index + 1] as Point];
    const reach = (b.x - a.x) * (index === 0 || index === final - 1 ? 0.5 : 1 / 3);
    let leave = { x: a.x + reach, y: a.y + reach * slope(index) };
    let arrive = { x: b.x - reach, y: b.y - reach * slope(index + 1) };
    if (risesFirst && index === 0) leave = { x: a.x, y: a.y + (b.y - a.y) * 0.8 };
    if (fallsLast && index === final - 1) arrive = { x: b.x, y: b.y + (a.y - b.y) * 0.8 };
    line += `C${text(leave)} ${text(arrive)} ${text(b)}`;
  }
  return line;
}

/** Interpolate between two paths, `part` from 0 to 1. */
export function interpolate(from: readonly Point[], to: readonly Point[], part: number): Point[] {
  const start = from.length === to.length ? from : resampled(from, to.length);
  return to.map(({ x, y }, index) => {
    const a = start[index] as Point;
    return { x: a.x + (x - a.x) * part, y: a.y + (y - a.y) * part };
  });
}

/** The same path with another number of points, at equal distances. */
function resampled(points: readonly Point[], count: number): Point[] {
  const far = [0];
  for (let index = 1; index < points.length; index += 1) {
    const [a, b] = [points[index - 1] as Point, points[index] as Point];
    far.push((far[index - 1] as number) + Math.hypot(b.x - a.x, b.y - a.y));
  }
  const whole = far.at(-1) as number;
  let index = 1;
  return Array.from({ length: count }, (_, number) => {
    const wanted = (whole * number) / (count - 1);
    while (index < points.length - 1 && (far[index] as number) < wanted) index += 1;
    const [a, b] = [points[index - 1] as Point, points[index] as Point];
    const [before, after] = [far[index - 1] as number, far[index] as number];
    const part = after > before ? (wanted - before) / (after - before) : 0;
    return { x: a.x + (b.x - a.x) * part, y: a.y + (b.y - a.y) * part };
  });
}
