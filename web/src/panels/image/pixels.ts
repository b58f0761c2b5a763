/**
 * The pixels of sensor_msgs/Image, as a canvas needs them.
 *
 * Encodings: sensor_msgs/image_encodings.h of ROS Noetic. Numbers beyond 8 bits are shown between
 * two limits, depths among them.
 */

import { checkImage } from "../../messages/sizes";

export interface RawImage {
  readonly width: number;
  readonly height: number;
  readonly encoding: string;
  readonly is_bigendian: number;
  /** Bytes from one row to the next. */
  readonly step: number;
  readonly data: Uint8Array;
}

/** The numbers that are shown as black and white. */
export type Limits = readonly [low: number, high: number];

export interface Shown {
  readonly pixels: ImageData;
  /** The limits that were used, for encodings of one number. */
  readonly limits?: Limits;
}

type Palette = "grey" | "color";

export interface Options {
  readonly palette: Palette;
  /** undefined: the numbers decide. */
  readonly limits?: Limits | undefined;
}

/** The places of red, green, blue (and opacity) among the numbers of a pixel. */
type Order = readonly [red: number, green: number, blue: number, alpha?: number];

interface Colors {
  readonly channels: number;
  readonly order: Order;
  /** Bytes of a number. */
  readonly size: 1 | 2;
}

const COLORS = new Map<string, Colors>(
  Object.entries({
    rgb8: { channels: 3, order: [0, 1, 2], size: 1 },
    bgr8: { channels: 3, order: [2, 1, 0], size: 1 },
    rgba8: { channels: 4, order: [0, 1, 2, 3], size: 1 },
    bgra8: { channels: 4, order: [2, 1, 0, 3], size: 1 },
    "8UC3": { channels: 3, order: [2, 1, 0], size: 1 },
    "8UC4": { channels: 4, order: [2, 1, 0, 3], size: 1 },
    mono8: { channels: 1, order: [0, 0, 0], size: 1 },
    "8UC1": { channels: 1, order: [0, 0, 0], size: 1 },
    rgb16: { channels: 3, order: [0, 1, 2], size: 2 },
    bgr16: { channels: 3, order: [2, 1, 0], size: 2 },
    rgba16: { channels: 4, order: [0, 1, 2, 3], size: 2 },
    bgra16: { channels: 4, order: [2, 1, 0, 3], size: 2 },
    "16UC3": { channels: 3, order: [2, 1, 0], size: 2 },
    "16UC4": { channels: 4, order: [2, 1, 0, 3], size: 2 },
  } satisfies Record<string, Colors>),
);

/** How one number per pixel is read, and its unit for depths: millimeters and meters. */
interface Numbers {
  readonly size: number;
  read(view: DataView, at: number, little: boolean): number;
  /** A typed array of these, if the machine's order of bytes is the image's. */
  readonly array: new (
    buffer: ArrayBufferLike,
    at: number,
    length: number,
  ) => ArrayLike<number>;
  readonly unit: string;
}

const NUMBERS = new Map<string, Numbers>([
  ["mono16", uint16("")],
  ["16UC1", uint16("mm")],
  [
    "16SC1",
    { size: 2, read: (view, at, little) => view.getInt16(at, little), array: Int16Array, unit: "" },
  ],
  [
    "32SC1",
    { size: 4, read: (view, at, little) => view.getInt32(at, little), array: Int32Array, unit: "" },
  ],
  [
    "32FC1",
    {
      size: 4,
      read: (view, at, little) => view.getFloat32(at, little),
      array: Float32Array,
      unit: "m",
    },
  ],
  [
    "64FC1",
    {
      size: 8,
      read: (view, at, little) => view.getFloat64(at, little),
      array: Float64Array,
      unit: "m",
    },
  ],
]);

function uint16(unit: string): Numbers {
  return {
    size: 2,
    read: (view, at, little) => view.getUint16(at, little),
    array: Uint16Array,
    unit,
  };
}

/** The colour of the first two pixels of the first row, and of the second row: r, g or b. */
const BAYER = new Map<string, string>(
  ["rggb", "bggr", "gbrg", "grbg"].flatMap((order) =>
    [8, 16].map((bits): [string, string] => [`bayer_${order}${bits}`, order]),
  ),
);
/** Where Y, U and V are in the four bytes of two pixels. */
const YUV = new Map<string, readonly [y0: number, u: number, y1: number, v: number]>([
  ["yuv422", [1, 0, 3, 2]],
  ["uyvy", [1, 0, 3, 2]],
  ["yuv422_yuy2", [0, 1, 2, 3]],
  ["yuyv", [0, 1, 2, 3]],
]);
const PLANES = new Map<string, readonly [u: number, v: number]>([
  ["nv12", [0, 1]],
  ["nv21", [1, 0]],
]);

/** The names of all encodings that are known. */
export const ENCODINGS: readonly string[] = [COLORS, NUMBERS, BAYER, YUV, PLANES].flatMap((all) => [
  ...all.keys(),
]);

/** Every such pixel counts for the limits. */
const SAMPLED = 16;
/** The parts of the numbers that lie below and above the limits. */
const OUTSIDE = 0.01;

/**
 * Convert an image to the pixels of a canvas.
 *
 * Throws an `Error` that says what is wrong with the image.
 */
export function toPixels(image: RawImage, options: Options): Shown {
  check(image);
  const pixels = new ImageData(image.width, image.height);
  const { encoding } = image;
  const colors = COLORS.get(encoding);
  const numbers = NUMBERS.get(encoding);
  const bayer = BAYER.get(encoding);
  const yuv = YUV.get(encoding);
  const planes = PLANES.get(encoding);
  if (colors !== undefined) drawColors(image, colors, pixels.data);
  else if (numbers !== undefined) {
    return { pixels, limits: drawNumbers(image, numbers, options, pixels.data) };
  } else if (bayer !== undefined) drawBayer(image, bayer, pixels.data);
  else if (yuv !== undefined) drawYuv(image, yuv, pixels.data);
  else if (planes !== undefined) drawPlanes(image, planes, pixels.data);
  return { pixels };
}

/** The value of one pixel as text: `1.83 m` or `rgb 12 200 7`. */
export function valueText(image: RawImage, x: number, y: number): string {
  const { data, step, is_bigendian } = image;
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const numbers = NUMBERS.get(image.encoding);
  if (numbers !== undefined) {
    const value = numbers.read(view, y * step + x * numbers.size, !is_bigendian);
    if (numbers.unit === "mm") return value === 0 ? "no depth" : `${(value / 1000).toFixed(3)} m`;
    if (numbers.unit === "m") return Number.isFinite(value) ? `${value.toFixed(3)} m` : "no depth";
    return String(value);
  }
  const colors = COLORS.get(image.encoding);
  if (colors === undefined) return "";
  const at = y * step + x * colors.channels * colors.size;
  const number = (place: number) =>
    colors.size === 1 ? view.getUint8(at + place) : view.getUint16(at + 2 * place, !is_bigendian);
  if (colors.channels === 1) return String(number(0));
  return `rgb ${colors.order
    .slice(0, 3)
    .map((place) => number(place as number))
    .join(" ")}`;
}

function check({ width, height, encoding, step, data }: RawImage): void {
  const bytes = bytesPerPixel(encoding);
  if (bytes === undefined) {
    throw new Error(`unknown encoding “${encoding}”: known are ${ENCODINGS.join(", ")}`);
  }
  // Planes of colours follow those of the brightness, with half as many rows.
  const rows = PLANES.has(encoding) ? height + Math.ceil(height / 2) : height;
  checkImage({ width, height, step, encoding, pixel: bytes, rows }, data.length);
}

function bytesPerPixel(encoding: string): number | undefined {
  const colors = COLORS.get(encoding);
  if (colors !== undefined) return colors.channels * colors.size;
  if (BAYER.has(encoding)) return encoding.endsWith("16") ? 2 : 1;
  if (YUV.has(encoding)) return 2;
  return PLANES.has(encoding) ? 1 : NUMBERS.get(encoding)?.size;
}

function drawColors(image: RawImage, colors: Colors, out: Uint8ClampedArray): void {
  const { width, height, step, data, is_bigendian } = image;
  const { channels, order, size } = colors;
  // Of 16 bits, the higher 8.
  const high = size === 2 && !is_bigendian ? 1 : 0;
  const [red, green, blue] = order.slice(0, 3).map((place) => (place ?? 0) * size + high) as [
    number,
    number,
    number,
  ];
  const alpha = order[3] === undefined ? -1 : order[3] * size + high;
  const stride = channels * size;
  let to = 0;
  for (let y = 0; y < height; y += 1) {
    let from = y * step;
    for (let x = 0; x < width; x += 1) {
      out[to] = data[from + red] as number;
      out[to + 1] = data[from + green] as number;
      out[to + 2] = data[from + blue] as number;
      out[to + 3] = alpha < 0 ? 255 : (data[from + alpha] as number);
      from += stride;
      to += 4;
    }
  }
}

function drawNumbers(
  image: RawImage,
  numbers: Numbers,
  { palette, limits }: Options,
  out: Uint8ClampedArray,
): Limits {
  const { width, height } = image;
  const values = rowReader(image, numbers);
  const isDepth = numbers.unit !== "";
  const isKnown = (value: number) => Number.isFinite(value) && !(isDepth && value <= 0);
  const used = limits ?? limitsOf(values, width, height, isKnown);
  const [low, high] = used;
  const scale = 255 / (high - low || 1);
  const table = PALETTES[palette];
  let to = 0;
  for (let y = 0; y < height; y += 1) {
    const row = values(y);
    for (let x = 0; x < width; x += 1) {
      const value = row[x] as number;
      out[to + 3] = 255;
      if (isKnown(value)) {
        const shade = Math.max(0, Math.min(255, Math.round((value - low) * scale))) * 3;
        out[to] = table[shade] as number;
        out[to + 1] = table[shade + 1] as number;
        out[to + 2] = table[shade + 2] as number;
      }
      to += 4;
    }
  }
  return used;
}

/** Return a function that returns the numbers of a row, copied if they cannot be read in place. */
function rowReader(image: RawImage, numbers: Numbers): (y: number) => ArrayLike<number> {
  const { width, step, data, is_bigendian } = image;
  const { size, read, array: TypedArray } = numbers;
  const start = data.byteOffset;
  if (!is_bigendian && start % size === 0 && step % size === 0) {
    return (y) => new TypedArray(data.buffer, start + y * step, width);
  }
  const view = new DataView(data.buffer, start, data.byteLength);
  const row = new Float64Array(width);
  return (y) => {
    for (let x = 0; x < width; x += 1) row[x] = read(view, y * step + x * size, !is_bigendian);
    return row;
  };
}

/** The numbers between which nearly all others lie. */
function limitsOf(
  values: (y: number) => ArrayLike<number>,
  width: number,
  height: number,
  isKnown: (value: number) => boolean,
): Limits {
  const found: number[] = [];
  const rowStep = height > SAMPLED ? 4 : 1;
  const columnStep = width > SAMPLED ? SAMPLED / rowStep : 1;
  for (let y = 0; y < height; y += rowStep) {
    const row = values(y);
    for (let x = 0; x < width; x += columnStep) {
      const value = row[x] as number;
      if (isKnown(value)) found.push(value);
    }
  }
  const sorted = Float64Array.from(found).sort();
  const at = (part: number) => sorted[Math.round(part * (sorted.length - 1))] ?? 0;
  return [at(OUTSIDE), at(1 - OUTSIDE)];
}

/** Draw the four sensors of each square as one colour. */
function drawBayer(image: RawImage, order: string, out: Uint8ClampedArray): void {
  const { width, height, step, data, encoding, is_bigendian } = image;
  const size = encoding.endsWith("16") ? 2 : 1;
  const high = size === 2 && !is_bigendian ? 1 : 0;
  const red = order.indexOf("r");
  const blue = order.indexOf("b");
  const [green, other] = [0, 1, 2, 3].filter((place) => place !== red && place !== blue) as [
    number,
    number,
  ];
  // At the end of an odd number of rows or columns, the square before is used.
  const lastX = Math.max(0, width - 2);
  const lastY = Math.max(0, height - 2);
  const sensor = (x: number, y: number, place: number): number =>
    data[
      Math.min(height - 1, y + (place >> 1)) * step +
        Math.min(width - 1, x + (place & 1)) * size +
        high
    ] as number;
  let to = 0;
  for (let y = 0; y < height; y += 1) {
    const top = Math.min(y & ~1, lastY & ~1);
    for (let x = 0; x < width; x += 1) {
      const left = Math.min(x & ~1, lastX & ~1);
      out[to] = sensor(left, top, red);
      out[to + 1] = (sensor(left, top, green) + sensor(left, top, other)) >> 1;
      out[to + 2] = sensor(left, top, blue);
      out[to + 3] = 255;
      to += 4;
    }
  }
}

function drawYuv(
  { width, height, step, data }: RawImage,
  [y0, u, y1, v]: readonly [number, number, number, number],
  out: Uint8ClampedArray,
): void {
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const pair = y * step + (x & ~1) * 2;
      const bright = data[pair + (x & 1 ? y1 : y0)] as number;
      setYuv(out, (y * width + x) * 4, bright, data[pair + u] ?? 128, data[pair + v] ?? 128);
    }
  }
}

function drawPlanes(
  { width, height, step, data }: RawImage,
  [u, v]: readonly [number, number],
  out: Uint8ClampedArray,
): void {
  const colors = height * step;
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const pair = colors + (y >> 1) * step + (x & ~1);
      const bright = data[y * step + x] as number;
      setYuv(out, (y * width + x) * 4, bright, data[pair + u] ?? 128, data[pair + v] ?? 128);
    }
  }
}

/** Set a pixel by its brightness and its two differences of colour (ITU-R BT.601). */
function setYuv(out: Uint8ClampedArray, at: number, y: number, u: number, v: number): void {
  const bright = 1.164 * (y - 16);
  out[at] = bright + 1.596 * (v - 128);
  out[at + 1] = bright - 0.392 * (u - 128) - 0.813 * (v - 128);
  out[at + 2] = bright + 2.017 * (u - 128);
  out[at + 3] = 255;
}

/** For each shade red, green and blue: from black to white, and from red (near) to blue (far). */
const PALETTES: Record<Palette, Uint8Array> = {
  grey: Uint8Array.from({ length: 768 }, (_, at) => Math.floor(at / 3)),
  color: Uint8Array.from({ length: 768 }, (_, at) => {
    const hue = (Math.floor(at / 3) / 255) * 4; // In sixths of the circle: red 0, blue 4.
    const away = Math.abs(hue - (at % 3) * 2);
    return 255 * Math.max(0, Math.min(1, 2 - Math.min(away, 6 - away)));
  }),
};
