/** Triangles of simple solids, each of which fits into a box of 1 m. */

import { append } from "../../lists";

/**
 * An arrow reaches from 0 to 1 along x: its shaft is as thick as 1, its head as 2, as in RViz.
 * Cylinders and cones stand on z; all others are about the origin.
 */
export type Shape = "box" | "sphere" | "cylinder" | "cone" | "arrow";

const SIDES = 16;
const RINGS = 8;
const SHAFT = 0.77;

/** Triangles as numbers: x, y and z of each corner, and of its normal. */
export function shapeTriangles(shape: Shape): Float32Array {
  const out: number[] = [];
  switch (shape) {
    case "box":
      box(out);
      break;
    case "sphere":
      for (let ring = 0; ring < RINGS; ring += 1) {
        const at = (k: number): [number, number] => {
          const angle = (Math.PI * k) / RINGS;
          return [Math.sin(angle) / 2, -Math.cos(angle) / 2];
        };
        turn(out, at(ring), at(ring + 1), "round");
      }
      break;
    case "cylinder":
      turn(out, [0, -0.5], [0.5, -0.5], [0, -1]);
      turn(out, [0.5, -0.5], [0.5, 0.5], [1, 0]);
      turn(out, [0.5, 0.5], [0, 0.5], [0, 1]);
      break;
    case "cone":
      turn(out, [0, -0.5], [0.5, -0.5], [0, -1]);
      turn(out, [0.5, -0.5], [0, 0.5], [2, 1]);
      break;
    case "arrow":
      turn(out, [0, 0], [0.5, 0], [0, -1]);
      turn(out, [0.5, 0], [0.5, SHAFT], [1, 0]);
      turn(out, [0.5, SHAFT], [1, SHAFT], [0, -1]);
      turn(out, [1, SHAFT], [0, 1], [1 - SHAFT, 1]);
      // From z to x.
      for (let at = 0; at < out.length; at += 3) {
        const [x = 0, y = 0, z = 0] = out.slice(at, at + 3);
        out.splice(at, 3, z, x, y);
      }
      break;
  }
  return Float32Array.from(out);
}

function box(out: number[]): void {
  for (const axis of [0, 1, 2]) {
    for (const side of [-1, 1]) {
      const corners = [
        [-1, -1],
        [side, -side],
        [1, 1],
        [-1, -1],
        [1, 1],
        [-side, side],
      ];
      for (const [a = 0, b = 0] of corners) {
        const place = [0, 0, 0];
        const normal = [0, 0, 0];
        place[axis] = side / 2;
        place[(axis + 1) % 3] = a / 2;
        place[(axis + 2) % 3] = b / 2;
        normal[axis] = side;
        append(out, [...place, ...normal]);
      }
    }
  }
}

/** Turn a line from one radius and height to another about z. */
function turn(
  out: number[],
  from: readonly [number, number],
  to: readonly [number, number],
  normal: readonly [number, number] | "round",
): void {
  for (let side = 0; side < SIDES; side += 1) {
    const corners = [
      [from, side],
      [from, side + 1],
      [to, side + 1],
      [from, side],
      [to, side + 1],
      [to, side],
    ] as const;
    for (const [[radius, height], step] of corners) {
      const angle = (2 * Math.PI * step) / SIDES;
      const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
      const [outward, upward] = normal === "round" ? [radius * 2, height * 2] : normal;
      const length = Math.hypot(outward, upward);
      out.push(radius * cosine, radius * sine, height);
      out.push((outward * cosine) / length, (outward * sine) / length, upward / length);
    }
  }
}
