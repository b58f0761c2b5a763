/**
 * PNG images of one channel of 16 bits, which browsers cut to 8: depths of cameras.
 *
 * Source: the PNG specification (https://www.w3.org/TR/png/), chunks and filters. Interlaced
 * images are not read.
 */

import { checkDeflated } from "../../messages/sizes";

export interface DeepImage {
  readonly width: number;
  readonly height: number;
  /** Big-endian numbers. */
  readonly data: Uint8Array;
}

const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
/** Bytes of a pixel. */
const SIZE = 2;

/** Whether some bytes are a PNG image of one channel of 16 bits. */
export function isDeepPng(bytes: Uint8Array): boolean {
  return SIGNATURE.every((byte, at) => bytes[at] === byte) && bytes[24] === 16 && bytes[25] === 0;
}

/** Read such an image; throws an `Error` if it is damaged. */
export async function readDeepPng(bytes: Uint8Array): Promise<DeepImage> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const width = view.getUint32(16);
  const height = view.getUint32(20);
  checkDeflated(width, height, SIZE, bytes.length);
  if (bytes[28] !== 0) throw new Error("interlaced PNG images of 16 bits cannot be shown");
  const row = width * SIZE;
  const filtered = await inflate(chunks(bytes, view), (row + 1) * height);
  if (filtered.length < (row + 1) * height) throw new Error("the PNG image ends early");
  const data = new Uint8Array(row * height);
  for (let y = 0; y < height; y += 1) unfilter(filtered, y * (row + 1), data, y * row, row);
  return { width, height, data };
}

/** The compressed data in an image. */
function chunks(bytes: Uint8Array, view: DataView): Uint8Array<ArrayBuffer>[] {
  const found: Uint8Array<ArrayBuffer>[] = [];
  for (let at = SIGNATURE.length; at + 12 <= bytes.length; ) {
    const length = view.getUint32(at);
    const kind = Array.from(bytes.subarray(at + 4, at + 8), (each) =>
      String.fromCharCode(each),
    ).join("");
    if (kind === "IDAT") found.push(bytes.slice(at + 8, at + 8 + length));
    at += 12 + length;
  }
  return found;
}

/** Decompress some data, but not much more than `most` bytes of it. */
async function inflate(parts: Uint8Array<ArrayBuffer>[], most: number): Promise<Uint8Array> {
  const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream("deflate"));
  const reader = stream.getReader();
  const whole = new Uint8Array(most);
  let at = 0;
  while (at < most) {
    const { done, value } = await reader.read();
    if (done) break;
    whole.set(value.subarray(0, most - at), at);
    at += value.length;
  }
  await reader.cancel();
  return whole.subarray(0, Math.min(at, most));
}

/** Undo the filter of one row, whose first byte names it. */
function unfilter(from: Uint8Array, start: number, to: Uint8Array, out: number, row: number): void {
  const filter = from[start];
  for (let x = 0; x < row; x += 1) {
    const left = x < SIZE ? 0 : (to[out + x - SIZE] as number);
    const up = out === 0 ? 0 : (to[out + x - row] as number);
    const corner = x < SIZE || out === 0 ? 0 : (to[out + x - row - SIZE] as number);
    let guess = 0;
    if (filter === 1) guess = left;
    else if (filter === 2) guess = up;
    else if (filter === 3) guess = (left + up) >> 1;
    else if (filter === 4) guess = paeth(left, up, corner);
    to[out + x] = (from[start + 1 + x] as number) + guess;
  }
}

function paeth(left: number, up: number, corner: number): number {
  const a = Math.abs(up - corner);
  const b = Math.abs(left - corner);
  const both = Math.abs(left + up - 2 * corner);
  if (a <= b && a <= both) return left;
  return b <= both ? up : corner;
}
