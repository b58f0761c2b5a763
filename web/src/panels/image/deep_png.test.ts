import { describe, expect, it } from "vitest";
import { bytesOf } from "../../types";
import { isDeepPng, readDeepPng } from "./deep_png";

/** 5 x 5 pixels, the n-th of which is 1234 n. Each row has another one of PNG's five filters. */
const IMAGE = bytesOf(
  "iVBORw0KGgoAAAANSUhEUgAAAAUAAAAFEAAAAAD4lKV6AAAAN0lEQVR42mNgYGC5xLmEr0zYg1FCiuUSKxgySUhJSkmAIbOBCf83vjL+b/zfWCSkWN+wghS9AQBeqg31gFw6ewAAAABJRU5ErkJggg==",
) as Uint8Array;

describe("readDeepPng", () => {
  it("undoes every filter", async () => {
    expect(isDeepPng(IMAGE)).toBe(true);
    const { width, height, data } = await readDeepPng(IMAGE);
    expect([width, height]).toEqual([5, 5]);
    const view = new DataView(data.buffer);
    const numbers = Array.from({ length: 25 }, (_, at) => view.getUint16(2 * at));
    expect(numbers).toEqual(Array.from({ length: 25 }, (_, at) => 1234 * at));
  });

  it("refuses images that are cut, too large or interlaced", async () => {
    await expect(readDeepPng(IMAGE.slice(0, 60))).rejects.toThrow();
    const large = IMAGE.slice();
    large.set([255, 255, 255, 255], 16);
    await expect(readDeepPng(large)).rejects.toThrow("4294967295 × 5 pixels");
    const interlaced = IMAGE.slice();
    interlaced[28] = 1;
    await expect(readDeepPng(interlaced)).rejects.toThrow("interlaced");
  });

  it("is not for other images", () => {
    const colors = IMAGE.slice();
    colors[25] = 2;
    expect(isDeepPng(colors)).toBe(false);
    expect(isDeepPng(IMAGE.slice(0, 20))).toBe(false);
    expect(isDeepPng(Uint8Array.of(0xff, 0xd8))).toBe(false);
  });
});
