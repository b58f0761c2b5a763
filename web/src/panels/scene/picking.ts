/** Finds what is under the pointer. */
import { applied, IDENTITY, type Transform, type Vector } from "../../transforms";
import { type Pointer, REACH, type View } from "./layer";
import { matrixOf, product } from "./matrix";

/** Most points that are looked at; of more, only some are. */
const MAX_POINTS = 100_000;

export interface NearPoint {
  readonly index: number;
  /** In the fixed frame. */
  readonly place: Vector;
  /** To the pointer, in CSS pixels. */
  readonly distance: number;
}

/**
 * The point nearest to the pointer, and of several the one nearest to the camera.
 *
 * `numbers` has x, y and z of each point, `step` numbers after those of the one before.
 */
export function nearestPoint(
  view: View,
  { x, y }: Pointer,
  model: Transform,
  numbers: ArrayLike<number>,
  step: number,
): NearPoint | undefined {
  const m = product(view.camera.matrix, matrixOf(model)) as number[];
  const [m0 = 0, m1 = 0, , m3 = 0, m4 = 0, m5 = 0, , m7 = 0, m8 = 0, m9 = 0, , m11 = 0] = m;
  const [m12 = 0, m13 = 0, , m15 = 0] = m.slice(12);
  const { width, height } = view.camera;
  const count = Math.floor(numbers.length / step);
  const every = Math.ceil(count / MAX_POINTS);
  let least = REACH * REACH;
  let found = -1;
  for (let index = 0; index < count; index += every) {
    const at = index * step;
    const [a, b, c] = [numbers[at] as number, numbers[at + 1] as number, numbers[at + 2] as number];
    const w = m3 * a + m7 * b + m11 * c + m15;
    if (!(w > 0)) continue;
    const dx = (((m0 * a + m4 * b + m8 * c + m12) / w + 1) * width) / 2 - x;
    const dy = ((1 - (m1 * a + m5 * b + m9 * c + m13) / w) * height) / 2 - y;
    const square = dx * dx + dy * dy;
    if (square < least) {
      least = square;
      found = index;
    }
  }
  if (found < 0) return undefined;
  const [px, py, pz] = [0, 1, 2].map((axis) => numbers[found * step + axis] as number);
  const place = applied(model, { x: px as number, y: py as number, z: pz as number });
  return { index: found, place, distance: Math.sqrt(least) };
}

/** A place in words: `1.25, -3.40, 0.00 m`. */
export function placeText({ x, y, z }: Vector): string {
  return `${[x, y, z].map((each) => each.toFixed(2)).join(", ")} m`;
}

/** The corners of the box around some points, in the fixed frame; points with NaN count not. */
export function corners(
  numbers: ArrayLike<number>,
  step: number,
  model: Transform = IDENTITY,
): Vector[] {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let at = 0; at + 2 < numbers.length; at += step) {
    for (let axis = 0; axis < 3; axis += 1) {
      const value = numbers[at + axis] as number;
      if (value < (low[axis] as number)) low[axis] = value;
      if (value > (high[axis] as number)) high[axis] = value;
    }
  }
  if (!low.every(Number.isFinite) || !high.every(Number.isFinite)) return [];
  return Array.from({ length: 8 }, (_, corner) => {
    const pick = (axis: number): number => ((corner >> axis) & 1 ? high : low)[axis] as number;
    return applied(model, { x: pick(0), y: pick(1), z: pick(2) });
  });
}
