/**
 * Checks of the sizes that messages claim, against the bytes that are there.
 *
 * A message of 100 bytes may claim a billion pixels: check it before anything is allocated for
 * them. Each check throws an `Error` that says what is wrong.
 */

/** Most pixels of an image, and most cells of a grid. */
const MAX_CELLS = 2 ** 26;
/** Deflate, the compression of PNG, makes at most this many bytes of one. */
const MAX_DEFLATE_RATIO = 1032;

export interface ImageSize {
  readonly width: number;
  readonly height: number;
  /** Bytes from one row to the next. */
  readonly step: number;
  readonly encoding: string;
  /** Bytes of a pixel. */
  readonly pixel: number;
  /** Rows of data, if these are more than those of pixels. */
  readonly rows?: number;
}

/** Check an image, whose last row needs no padding. */
export function checkImage(
  { width, height, step, encoding, pixel, rows = height }: ImageSize,
  length: number,
): void {
  checkCount("image", "pixels", width, height);
  if (step < width * pixel) {
    throw new Error(
      `step is ${step} bytes, but ${width} pixels of ${encoding} are ${width * pixel}`,
    );
  }
  const least = step * (rows - 1) + width * pixel;
  if (length < least) {
    throw new Error(`the data has ${length} bytes, but ${width} × ${height} need ${least}`);
  }
}

/** Check a grid. */
export function checkGrid(width: number, height: number, length: number): void {
  checkCount("map", "cells", width, height);
  if (length < width * height) {
    throw new Error(`the data has ${length} cells, but ${width} × ${height} are expected`);
  }
}

/** Check the size that a PNG image would have, in bytes with its filters. */
export function checkDeflated(
  width: number,
  height: number,
  pixel: number,
  compressed: number,
): void {
  checkCount("PNG image", "pixels", width, height);
  if ((width * pixel + 1) * height > compressed * MAX_DEFLATE_RATIO) {
    throw new Error(
      `the PNG image ends early: ${compressed} bytes for ${width} × ${height} pixels`,
    );
  }
}

/** Check a compressed picture by its head, before the browser decodes it: PNG, JPEG or WebP. */
export function checkPicture(data: Uint8Array): void {
  const [width, height] = pictureSize(data) ?? [1, 1];
  checkCount("picture", "pixels", width, height);
}

/** The width and the height in the head of a picture, if they can be found. */
export function pictureSize(data: Uint8Array): [width: number, height: number] | undefined {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const starts = (...start: number[]) => start.every((byte, at) => data[at] === byte);
  try {
    if (starts(0x89, 0x50)) return [view.getUint32(16), view.getUint32(20)];
    if (starts(0xff, 0xd8)) return jpegSize(view);
    if (starts(0x52, 0x49)) return webpSize(view);
  } catch (error) {
    if (!(error instanceof RangeError)) throw error; // The head is cut off.
  }
  return undefined;
}

function jpegSize(view: DataView): [number, number] | undefined {
  for (let at = 2; view.getUint8(at) === 0xff; ) {
    const kind = view.getUint8(at + 1);
    if (kind >= 0xc0 && kind <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(kind)) {
      return [view.getUint16(at + 7), view.getUint16(at + 5)];
    }
    // Bytes of 0xff may come before a marker, and some markers have no length.
    const isAlone = kind === 0x01 || (kind >= 0xd0 && kind <= 0xd8);
    if (kind === 0xff) at += 1;
    else at += isAlone ? 2 : 2 + Math.max(2, view.getUint16(at + 2));
  }
  return undefined;
}

function webpSize(view: DataView): [number, number] | undefined {
  const three = (at: number) => view.getUint16(at, true) + 65536 * view.getUint8(at + 2);
  const kind = [12, 13, 14, 15].map((at) => String.fromCharCode(view.getUint8(at))).join("");
  if (kind === "VP8X") return [three(24) + 1, three(27) + 1];
  if (kind === "VP8 ")
    return [view.getUint16(26, true) & 0x3fff, view.getUint16(28, true) & 0x3fff];
  if (kind !== "VP8L") return undefined;
  const bits = view.getUint32(21, true);
  return [(bits & 0x3fff) + 1, ((bits >>> 14) & 0x3fff) + 1];
}

export interface CloudSize {
  /** Bytes from one row to the next. */
  readonly rowSize: number;
  /** The points that are there: fewer than claimed if bytes are missing. */
  readonly total: number;
  /** What is wrong, though some points may be there. */
  readonly fault: string;
}

/** Return how many points a cloud has; its last row needs no padding. */
export function sizeOfCloud(
  width: number,
  height: number,
  rowStep: number,
  pointStep: number,
  length: number,
): CloudSize {
  const row = width * pointStep;
  const rowSize = Math.max(rowStep, row);
  const claimed = width * height;
  if (claimed === 0) return { rowSize, total: 0, fault: "" };
  if (!(pointStep > 0)) throw new Error(`point_step must be above 0, got ${pointStep}`);
  const expected = (height - 1) * rowSize + row;
  if (length >= expected) return { rowSize, total: claimed, fault: "" };
  const full = Math.floor(length / rowSize);
  const rest = Math.min(width, Math.floor((length - full * rowSize) / pointStep));
  return {
    rowSize,
    total: Math.min(claimed, full * width + rest),
    fault: `the data has ${length} bytes, but ${width} × ${height} points take ${expected}`,
  };
}

function checkCount(what: string, cells: string, width: number, height: number): void {
  const count = width * height;
  if (!(count > 0)) throw new Error(`the ${what} has no ${cells}: ${width} × ${height}`);
  if (count > MAX_CELLS) throw new Error(`${width} × ${height} ${cells} are too many`);
}
