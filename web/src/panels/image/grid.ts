/** The picture of nav_msgs/OccupancyGrid, in the colours of RViz's palette "map". */
import type { Fields } from "../../messages/reader";
import { checkGrid } from "../../messages/sizes";
import { bytesOf } from "../../types";

export interface Grid {
  readonly width: number;
  readonly height: number;
  /** The edge of a cell, in m. */
  readonly resolution: number;
  /** Where the lower left corner is, in m, and how the grid is turned there, in radians. */
  readonly origin: { readonly x: number; readonly y: number; readonly yaw: number };
  readonly frame: string;
  /** Row by row, from the lower left corner on. */
  readonly cells: Int8Array;
}

const UNKNOWN = -1;
/** For each cell, as a byte without a sign: red, green and blue. */
const PALETTE = Uint8Array.from(
  { length: 256 * 3 },
  (_, at) => color(Math.floor(at / 3))[at % 3] ?? 0,
);

/** Free is white and occupied black; values that no cell should have are green, and red to yellow. */
function color(value: number): readonly [number, number, number] {
  if (value === (UNKNOWN & 255)) return [0x70, 0x89, 0x86];
  if (value > 127) return [255, Math.round((255 * (value - 128)) / 126), 0];
  if (value > 100) return [0, 255, 0];
  const shade = 255 - Math.round((255 * value) / 100);
  return [shade, shade, shade];
}

/** Whether a message is a grid. */
export function isGrid(message: Fields): boolean {
  return "info" in message && "data" in message;
}

/** Read a message; throws an `Error` that says what is wrong with it. */
export function readGrid({ header, info, data }: Fields): Grid {
  const { width, height, resolution, origin } = info as {
    width: number;
    height: number;
    resolution: number;
    origin: {
      position: { x: number; y: number };
      orientation: { x: number; y: number; z: number; w: number };
    };
  };
  const cells = cellsOf(data);
  checkGrid(width, height, cells.length);
  const { x, y, z, w } = origin.orientation;
  const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  const place = { x: origin.position.x, y: origin.position.y, yaw };
  const frame = String((header as Fields | undefined)?.frame_id ?? "");
  return { width, height, resolution, origin: place, frame, cells };
}

/** Cells arrive as bytes, or in JSON as a list. */
function cellsOf(data: unknown): Int8Array {
  if (data instanceof Int8Array) return data;
  if (typeof data === "string") return new Int8Array((bytesOf(data) ?? new Uint8Array()).buffer);
  return Int8Array.from(data as ArrayLike<number>);
}

/** Return the pixels of a grid, whose upper row is the last one. */
export function gridPixels({ width, height, cells }: Grid): ImageData {
  const pixels = new ImageData(width, height);
  const out = pixels.data;
  let to = 0;
  for (let y = height - 1; y >= 0; y -= 1) {
    const row = y * width;
    for (let x = 0; x < width; x += 1) {
      const at = ((cells[row + x] as number) & 255) * 3;
      out[to] = PALETTE[at] as number;
      out[to + 1] = PALETTE[at + 1] as number;
      out[to + 2] = PALETTE[at + 2] as number;
      out[to + 3] = 255;
      to += 4;
    }
  }
  return pixels;
}

/** The value of a cell, by the place of its pixel: `0 (free) at 1.25 m, -3.40 m in map`. */
export function cellText(grid: Grid, x: number, y: number): string {
  const { width, height, resolution, origin, frame, cells } = grid;
  const row = height - 1 - y;
  const value = cells[row * width + x] as number;
  const meaning = value === 0 ? " (free)" : value === 100 ? " (occupied)" : "";
  const [right, up] = [(x + 0.5) * resolution, (row + 0.5) * resolution];
  const [cosine, sine] = [Math.cos(origin.yaw), Math.sin(origin.yaw)];
  const east = origin.x + right * cosine - up * sine;
  const north = origin.y + right * sine + up * cosine;
  const what = value === UNKNOWN ? "unknown" : `${value}${meaning}`;
  return `${what} at ${east.toFixed(2)} m, ${north.toFixed(2)} m${frame === "" ? "" : ` in ${frame}`}`;
}
