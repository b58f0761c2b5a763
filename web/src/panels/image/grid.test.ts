import { beforeAll, expect, it, vi } from "vitest";
import { cellText, gridPixels, isGrid, readGrid } from "./grid";

class FakeImageData {
  readonly data: Uint8ClampedArray;

  constructor(width: number, height: number) {
    this.data = new Uint8ClampedArray(4 * width * height);
  }
}

beforeAll(() => {
  vi.stubGlobal("ImageData", FakeImageData);
});

function message(width: number, height: number, data: ArrayLike<number>, yaw = 0) {
  const position = { x: 10, y: -2, z: 0 };
  const orientation = { x: 0, y: 0, z: Math.sin(yaw / 2), w: Math.cos(yaw / 2) };
  const info = { width, height, resolution: 0.5, origin: { position, orientation } };
  return { header: { frame_id: "map" }, info, data };
}

it("has the last row on top, in RViz's colours", () => {
  const grid = readGrid(message(2, 3, Int8Array.of(0, 100, -1, 50, 101, -128)));
  const { data } = gridPixels(grid);
  const colors = Array.from({ length: 6 }, (_, at) => [...data.slice(4 * at, 4 * at + 3)]);
  expect(colors).toEqual([
    [0, 255, 0],
    [255, 0, 0],
    [0x70, 0x89, 0x86],
    [127, 127, 127],
    [255, 255, 255],
    [0, 0, 0],
  ]);
});

it("says what a cell is, and where", () => {
  const cells = Int8Array.of(0, 100, -1, 50);
  const grid = readGrid(message(2, 2, cells));
  expect(cellText(grid, 0, 1)).toBe("0 (free) at 10.25 m, -1.75 m in map");
  expect(cellText(grid, 1, 1)).toBe("100 (occupied) at 10.75 m, -1.75 m in map");
  expect(cellText(grid, 0, 0)).toBe("unknown at 10.25 m, -1.25 m in map");
  const turned = readGrid(message(2, 2, cells, Math.PI / 2));
  expect(cellText(turned, 1, 1)).toBe("100 (occupied) at 9.75 m, -1.25 m in map");
});

it("reads lists of JSON", () => {
  expect([...readGrid(message(2, 1, [-1, 100])).cells]).toEqual([-1, 100]);
});

it.each([
  [message(2, 2, [1]), "the data has 1 cells, but 2 × 2 are expected"],
  [message(0, 2, []), "no cells"],
  [message(100_000, 100_000, []), "too many"],
])("says what is wrong with a map", (wrong, fault) => {
  expect(() => readGrid(wrong)).toThrow(fault);
});

it("is not an image", () => {
  expect(isGrid(message(1, 1, [0]))).toBe(true);
  expect(isGrid({ encoding: "rgb8", data: [] })).toBe(false);
});
