import { expect, it } from "vitest";
import { checkDeflated, checkGrid, checkImage, sizeOfCloud } from "./sizes";

const MOST = 2 ** 32 - 1;

function faultOf(check: () => void): string {
  try {
    check();
  } catch (error) {
    return (error as Error).message;
  }
  return "";
}

it.each([
  [2, 2, 6, 12, ""],
  [2, 2, 8, 14, ""],
  [2, 2, 6, 11, "need 12"],
  [2, 2, 5, 12, "step is 5"],
  [30_000, 2000, 0, 100, "step is 0"],
  [30_000, 30_000, 90_000, 100, "too many"],
  [8000, 8000, 24_000, 100, "need"],
  [MOST, MOST, MOST, 100, "too many"],
  [0, MOST, 0, 100, "no pixels"],
])("an image of %i × %i with step %i and %i bytes", (width, height, step, length, fault) => {
  const found = faultOf(() =>
    checkImage({ width, height, step, encoding: "rgb8", pixel: 3 }, length),
  );
  expect(found === "" ? "" : found).toContain(fault);
  expect(found === "").toBe(fault === "");
});

it.each([
  [2, 3, 6, ""],
  [2, 3, 7, ""],
  [2, 3, 5, "5 cells"],
  [0, MOST, 0, "no cells"],
  [MOST, MOST, 6, "too many"],
])("a grid of %i × %i with %i cells", (width, height, length, fault) => {
  const found = faultOf(() => checkGrid(width, height, length));
  expect(found).toContain(fault);
  expect(found === "").toBe(fault === "");
});

it.each([
  [100, 100, 100, ""],
  [8000, 8000, 200, "200 bytes"],
  [MOST, MOST, 200, "too many"],
  [0, 1, 200, "no pixels"],
])("a PNG image of %i × %i pixels in %i bytes", (width, height, length, fault) => {
  const found = faultOf(() => checkDeflated(width, height, 2, length));
  expect(found).toContain(fault);
  expect(found === "").toBe(fault === "");
});

it.each([
  [2, 2, 32, 16, 64, 4, false],
  [2, 2, 40, 16, 72, 4, false],
  [2, 2, 0, 16, 64, 4, false],
  [2, 2, 32, 16, 63, 3, true],
  [MOST, 1, MOST, 16, 64, 4, true],
  [1, MOST, 16, 16, 64, 4, true],
  [0, MOST, 0, 16, 0, 0, false],
])("a cloud of %i × %i, steps %i and %i, %i bytes has %i points", (...given) => {
  const [width, height, row, point, length, total, isFaulty] = given;
  const found = sizeOfCloud(width, height, row, point, length);
  expect([found.total, found.fault !== ""]).toEqual([total, isFaulty]);
});

it("refuses points without bytes", () => {
  expect(faultOf(() => sizeOfCloud(MOST, MOST, 0, 0, 64))).toContain("point_step");
});
