import { expect, it } from "vitest";
import {
  checkDeflated,
  checkGrid,
  checkImage,
  checkPicture,
  pictureSize,
  sizeOfCloud,
} from "./sizes";

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

const ascii = (text: string) => [...text].map((each) => each.charCodeAt(0));
const png = (...size: number[]) => [0x89, 0x50, 0x4e, 0x47, ...new Array(12).fill(0), ...size];
const jpeg = (...size: number[]) => [
  0xff,
  0xd8,
  0xff,
  0xe0,
  0,
  4,
  1,
  2,
  0xff,
  0xc0,
  0,
  17,
  8,
  ...size,
];
const webp = (kind: string, ...rest: number[]) => [...ascii(`RIFF____WEBP${kind}____`), ...rest];

it.each([
  ["PNG", png(0, 0, 2, 128, 0, 0, 1, 224), [640, 480]],
  ["JPEG", jpeg(1, 224, 2, 128), [640, 480]],
  ["WebP with a head", webp("VP8X", 0, 0, 0, 0, 0x7f, 2, 0, 0xdf, 1, 0), [640, 480]],
  ["WebP", webp("VP8 ", 0, 0, 0, 0, 0, 0, 0x80, 2, 0xe0, 1), [640, 480]],
  ["lossless WebP", webp("VP8L", 0x2f, 0x7f, 0xc2, 0x77, 0), [640, 480]],
  ["WebP of another kind", webp("ALPH", 0, 0, 0), undefined],
  ["nothing", [], undefined],
  ["JPEG that is cut off", [0xff, 0xd8, 0xff, 0xe0, 0, 0], undefined],
  ["GIF", ascii("GIF89a"), undefined],
])("the size of %s is in its head", (_, data, size) => {
  expect(pictureSize(Uint8Array.from(data))).toEqual(size);
  expect(() => checkPicture(Uint8Array.from(data))).not.toThrow();
});

it("a picture that claims too many pixels is refused before it is decoded", () => {
  const most = [255, 255, 255, 255];
  for (const data of [png(...most, ...most), jpeg(...most), webp("VP8L", 0x2f, ...most)]) {
    expect(faultOf(() => checkPicture(Uint8Array.from(data)))).toContain("too many");
  }
});
