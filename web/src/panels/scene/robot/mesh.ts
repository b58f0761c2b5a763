/** Meshes as triangles for WebGL, and the reader of STL. */
import type { Color } from "../colors";

/** Triangles of one mesh at most. */
const MAX_TRIANGLES = 2_000_000;

/** Corners of triangles: x, y, z and the normal as float32, and for some 4 bytes of colour. */
export interface MeshData {
  readonly plain: Float32Array<ArrayBuffer>;
  /** The corners with a colour of their own. */
  readonly colored: Float32Array<ArrayBuffer>;
}

/** Numbers of a corner without a colour, and with one. */
export const [PLAIN, COLORED] = [6, 7];

type Point = readonly [x: number, y: number, z: number];

/** Collects triangles. */
export class MeshBuilder {
  readonly #plain = new Numbers();
  readonly #colored = new Numbers();
  #count = 0;

  /**
   * Add a triangle.
   *
   * Without normals, it is flat. Triangles with numbers that are not finite are left out.
   */
  add(
    a: Point,
    b: Point,
    c: Point,
    color: Color | undefined,
    normals?: readonly [Point, Point, Point],
  ): void {
    const flat = normals === undefined ? normalOf(a, b, c) : undefined;
    if (![...a, ...b, ...c].every(Number.isFinite)) return;
    this.#count += 1;
    if (this.#count > MAX_TRIANGLES) {
      throw new Error(`too many triangles (limit ${MAX_TRIANGLES})`);
    }
    const numbers = color === undefined ? this.#plain : this.#colored;
    const bytes = color === undefined ? undefined : packed(color);
    for (const [index, corner] of [a, b, c].entries()) {
      const normal = flat ?? ((normals as readonly Point[])[index] as Point);
      numbers.push(corner, normal, bytes);
    }
  }

  get data(): MeshData {
    return { plain: this.#plain.used, colored: this.#colored.used };
  }
}

/** Numbers in an array that grows. */
class Numbers {
  #numbers = new Float32Array(1024);
  #bytes = new Uint32Array(this.#numbers.buffer);
  #length = 0;

  push([x, y, z]: Point, [a, b, c]: Point, color: number | undefined): void {
    if (this.#length + COLORED > this.#numbers.length) {
      const larger = new Float32Array(this.#numbers.length * 2);
      larger.set(this.#numbers);
      this.#numbers = larger;
      this.#bytes = new Uint32Array(larger.buffer);
    }
    const at = this.#length;
    const numbers = this.#numbers;
    numbers[at] = x;
    numbers[at + 1] = y;
    numbers[at + 2] = z;
    numbers[at + 3] = a;
    numbers[at + 4] = b;
    numbers[at + 5] = c;
    if (color !== undefined) this.#bytes[at + 6] = color;
    this.#length += color === undefined ? PLAIN : COLORED;
  }

  get used(): Float32Array<ArrayBuffer> {
    return this.#numbers.slice(0, this.#length);
  }
}

/** A colour as 4 bytes: red comes first. */
export function packed(color: Color): number {
  const [red, green, blue, alpha] = color.map((each) =>
    Math.round(255 * Math.min(1, Math.max(0, each))),
  ) as [number, number, number, number];
  return (red | (green << 8) | (blue << 16) | (alpha << 24)) >>> 0;
}

/** The direction of a triangle's front. */
export function normalOf(a: Point, b: Point, c: Point): Point {
  const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
  const [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
  const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const length = Math.hypot(x, y, z);
  // Of a triangle that is a line, any will do.
  return length > 0 ? [x / length, y / length, z / length] : [0, 0, 1];
}

/** Bytes before the first triangle of a binary STL, and of each. */
const [HEAD, FACET] = [84, 50];

/** Read an STL file, binary or text; throws an `Error` that says where what is wrong. */
export function readStl(data: Uint8Array): MeshData {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const head = new TextDecoder().decode(data.subarray(0, 1000));
  const isText = /^solid\b.*\b(facet|vertex|endsolid)\b/is.test(head);
  const count = data.length < HEAD ? -1 : view.getUint32(80, true);
  // The head of a binary one may begin with any word.
  if (isText && data.length !== HEAD + FACET * count) {
    return readTextStl(new TextDecoder().decode(data));
  }
  if (count < 0) throw new Error(`expected STL, got ${data.length} bytes`);
  if (data.length < HEAD + FACET * count) {
    const needed = HEAD + FACET * count;
    throw new Error(`byte 80: ${count} triangles take ${needed} bytes, got ${data.length}`);
  }
  const builder = new MeshBuilder();
  for (let index = 0; index < count; index += 1) {
    const point = (corner: number): Point => {
      const at = HEAD + FACET * index + 12 * corner + 12;
      return [
        view.getFloat32(at, true),
        view.getFloat32(at + 4, true),
        view.getFloat32(at + 8, true),
      ];
    };
    builder.add(point(0), point(1), point(2), undefined);
  }
  return builder.data;
}

function readTextStl(text: string): MeshData {
  const builder = new MeshBuilder();
  let corners: Point[] = [];
  for (const [number, words] of lines(text)) {
    if (words[0] === "vertex") corners.push(pointOf(number, words));
    if (words[0] !== "endloop") continue;
    if (corners.length < 3) throw new LineError(number, `a facet of ${corners.length} corners`);
    for (let at = 2; at < corners.length; at += 1) {
      builder.add(corners[0] as Point, corners[at - 1] as Point, corners[at] as Point, undefined);
    }
    corners = [];
  }
  if (corners.length > 0) throw new Error("the last facet has no end");
  return builder.data;
}

export class LineError extends Error {
  constructor(line: number, fault: string) {
    super(`line ${line}: ${fault}`);
  }
}

/** The lines of a text that are not empty, as words, with their numbers. */
export function* lines(text: string): Generator<[number: number, words: string[]]> {
  let number = 0;
  for (let at = 0; at < text.length; ) {
    const next = text.indexOf("\n", at);
    const end = next < 0 ? text.length : next;
    number += 1;
    const line = text.slice(at, end).trim();
    if (line !== "") yield [number, line.split(/\s+/)];
    at = end + 1;
  }
}

/** The three numbers after the first word of a line. */
export function pointOf(line: number, words: readonly string[]): Point {
  const [x, y, z] = words.slice(1, 4).map(Number);
  if (x === undefined || y === undefined || z === undefined || Number.isNaN(x + y + z)) {
    throw new LineError(
      line,
      `expected 3 numbers after ${words[0]}, got ${words.slice(1, 5).join(" ")}`,
    );
  }
  return [x, y, z];
}

export type { Point };
