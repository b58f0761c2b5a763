import { beforeAll, describe, expect, it, vi } from "vitest";
import { ENCODINGS, type Options, type RawImage, toPixels, valueText } from "./pixels";

/** Node has no canvas. */
class FakeImageData {
  readonly width: number;
  readonly height: number;
  readonly data: Uint8ClampedArray;

  constructor(width: number, height: number) {
    this.width = width;
    this.height = height;
    this.data = new Uint8ClampedArray(4 * width * height);
  }
}

beforeAll(() => {
  vi.stubGlobal("ImageData", FakeImageData);
});

const GREY: Options = { palette: "grey" };

function image(encoding: string, width: number, data: number[], more: Partial<RawImage> = {}) {
  const bytes = Uint8Array.from(data);
  const height = more.height ?? 1;
  return {
    width,
    height,
    encoding,
    is_bigendian: 0,
    step: bytes.length / height,
    data: bytes,
    ...more,
  };
}

/** The red, green and blue of each pixel. */
function colors(shown: RawImage, options = GREY): number[][] {
  const { data } = toPixels(shown, options).pixels;
  return Array.from({ length: data.length / 4 }, (_, at) => [...data.slice(4 * at, 4 * at + 3)]);
}

const RED = [255, 0, 0];
const BLUE = [0, 0, 255];

describe("toPixels", () => {
  it.each([
    ["rgb8", [255, 0, 0, 0, 0, 255]],
    ["bgr8", [0, 0, 255, 255, 0, 0]],
    ["8UC3", [0, 0, 255, 255, 0, 0]],
    ["rgba8", [255, 0, 0, 255, 0, 0, 255, 255]],
    ["bgra8", [0, 0, 255, 255, 255, 0, 0, 255]],
    ["8UC4", [0, 0, 255, 255, 255, 0, 0, 255]],
    ["rgb16", [9, 255, 0, 0, 0, 0, 0, 0, 0, 0, 9, 255]],
    ["bgra16", [0, 0, 0, 0, 0, 255, 0, 255, 0, 255, 0, 0, 0, 0, 0, 255]],
  ])("converts %s", (encoding, data) => {
    expect(colors(image(encoding, 2, data))).toEqual([RED, BLUE]);
  });

  it("keeps the rows of padded images, and the order of big numbers", () => {
    expect(colors(image("mono8", 1, [7, 99, 8, 99], { height: 2 }))).toEqual([
      [7, 7, 7],
      [8, 8, 8],
    ]);
    const big = image("16UC1", 2, [0, 10, 1, 10], { is_bigendian: 1 });
    expect(toPixels(big, GREY).limits).toEqual([10, 266]);
  });

  it("shows numbers between limits, and unknown depths black", () => {
    const depths = image("16UC1", 4, [0, 0, 100, 0, 200, 0, 44, 1]);
    expect(toPixels(depths, GREY).limits).toEqual([100, 300]);
    expect(colors(depths).map(([red]) => red)).toEqual([0, 0, 127, 255]);
    expect(colors(depths, { palette: "grey", limits: [0, 400] })[1]).toEqual([64, 64, 64]);
    const color = { palette: "color", limits: [100, 300] } as const;
    expect(colors(depths, color)).toEqual([[0, 0, 0], RED, expect.any(Array), BLUE]);
    const meters = new Uint8Array(Float32Array.of(1, Number.NaN, 3).buffer);
    expect(toPixels(image("32FC1", 3, [...meters]), GREY).limits).toEqual([1, 3]);
  });

  it("reads numbers at odd offsets", () => {
    const whole = Uint8Array.of(99, 1, 0, 3, 0);
    const data = whole.subarray(1);
    expect(toPixels({ ...image("mono16", 2, []), step: 4, data }, GREY).limits).toEqual([1, 3]);
  });

  it.each([
    ["bayer_rggb8", [255, 0, 0, 10]],
    ["bayer_bggr8", [10, 0, 0, 255]],
    ["bayer_gbrg8", [0, 10, 255, 0]],
    ["bayer_grbg8", [0, 255, 10, 0]],
  ])("converts %s", (encoding, data) => {
    const square = image(encoding, 2, data, { height: 2 });
    expect(colors(square)).toEqual(Array.from({ length: 4 }, () => [255, 0, 10]));
  });

  it.each([
    ["yuv422", [128, 16, 128, 235]],
    ["uyvy", [128, 16, 128, 235]],
    ["yuv422_yuy2", [16, 128, 235, 128]],
    ["yuyv", [16, 128, 235, 128]],
    ["nv12", [16, 235, 128, 128]],
    ["nv21", [16, 235, 128, 128]],
  ])("converts %s", (encoding, data) => {
    const step = encoding.startsWith("nv") ? 2 : 4;
    const [dark, bright] = colors(image(encoding, 2, data, { step }));
    expect(dark).toEqual([0, 0, 0]);
    expect(bright?.every((each) => each > 250)).toBe(true);
  });

  it("knows every encoding that it lists", () => {
    for (const encoding of ENCODINGS) {
      const shown = image(encoding, 2, [], { height: 2, step: 16, data: new Uint8Array(48) });
      expect(toPixels(shown, GREY).pixels.width).toBe(2);
      expect(typeof valueText(shown, 1, 1)).toBe("string");
    }
  });

  it.each([
    [image("xyz8", 1, [1]), "unknown encoding “xyz8”: known are rgb8"],
    [image("rgb8", 2, [1, 2, 3], { step: 6 }), "the data has 3 bytes, but 2 × 1 need 6"],
    [image("rgb8", 2, [1, 2, 3]), "step is 3 bytes, but 2 pixels of rgb8 are 6"],
    [image("rgb8", 0, []), "no pixels"],
    [image("mono8", 70_000, [], { height: 70_000, step: 70_000 }), "too many"],
  ])("says what is wrong with an image", (wrong, fault) => {
    expect(() => toPixels(wrong, GREY)).toThrow(fault);
  });
});

describe("valueText", () => {
  it.each([
    ["16UC1", [38, 7, 0, 0], 0, "1.830 m"],
    ["16UC1", [38, 7, 0, 0], 1, "no depth"],
    ["32FC1", [0, 0, 0, 64, 0, 0, 192, 127], 0, "2.000 m"],
    ["32FC1", [0, 0, 0, 64, 0, 0, 192, 127], 1, "no depth"],
    ["bgr8", [1, 2, 3, 4, 5, 6], 1, "rgb 6 5 4"],
    ["mono8", [9, 8], 1, "8"],
    ["mono16", [1, 1, 2, 0], 0, "257"],
  ])("is the pixel of %s", (encoding, data, x, text) => {
    expect(valueText(image(encoding, 2, data), x, 0)).toBe(text);
  });
});
