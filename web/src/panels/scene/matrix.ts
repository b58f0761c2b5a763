/** Matrices of 4 × 4 numbers, column by column, as WebGL takes them. */
import type { Transform, Vector } from "../../transforms";

export type Matrix = readonly number[];

export function product(a: Matrix, b: Matrix): Matrix {
  const out: number[] = new Array(16);
  for (let column = 0; column < 16; column += 4) {
    const [x = 0, y = 0, z = 0, w = 0] = b.slice(column, column + 4);
    for (let row = 0; row < 4; row += 1) {
      out[column + row] =
        (a[row] as number) * x +
        (a[row + 4] as number) * y +
        (a[row + 8] as number) * z +
        (a[row + 12] as number) * w;
    }
  }
  return out;
}

/** The matrix of a transform, after which a scale is applied: the scale comes first. */
export function matrixOf({ translation, rotation }: Transform, scale = ONE): Matrix {
  const { x, y, z, w } = rotation;
  const { x: a, y: b, z: c } = scale;
  return [
    a * (1 - 2 * (y * y + z * z)),
    a * 2 * (x * y + w * z),
    a * 2 * (x * z - w * y),
    0,
    b * 2 * (x * y - w * z),
    b * (1 - 2 * (x * x + z * z)),
    b * 2 * (y * z + w * x),
    0,
    c * 2 * (x * z + w * y),
    c * 2 * (y * z - w * x),
    c * (1 - 2 * (x * x + y * y)),
    0,
    translation.x,
    translation.y,
    translation.z,
    1,
  ];
}

const ONE: Vector = { x: 1, y: 1, z: 1 };
