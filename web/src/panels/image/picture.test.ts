import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Picture } from "./picture";

class FakeImageData {
  readonly data: Uint8ClampedArray;

  constructor(width: number, height: number) {
    this.data = new Uint8ClampedArray(4 * width * height);
  }
}

beforeEach(() => {
  vi.stubGlobal("ImageData", FakeImageData);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

function image(encoding: string): Record<string, unknown> {
  const data = Uint8Array.of(1, 2, 3);
  return { width: 1, height: 1, encoding, is_bigendian: 0, step: 3, data };
}

/** A picture without pixels, and what it reports: encodings that are drawn, and faults. */
function made(): { picture: Picture; reports: string[] } {
  const reports: string[] = [];
  const context = { putImageData: () => undefined };
  const canvas = { width: 1, height: 1, getContext: () => context } as unknown as OffscreenCanvas;
  const picture = new Picture(
    canvas,
    ({ encoding }) => reports.push(encoding),
    (why) => reports.push(why),
  );
  return { picture, reports };
}

it("shows the newest image with other colours as soon as they are chosen", async () => {
  const { picture, reports } = made();
  await picture.receive(image("rgb8"), 3);
  picture.options = { palette: "color" };
  await picture.receive(image("bgr8"), 3);
  expect(reports).toEqual(["rgb8", "rgb8", "bgr8"]);
});

it("does not show an older image again, without its fault, after one that cannot be shown", async () => {
  const { picture, reports } = made();
  await picture.receive(image("rgb8"), 3);
  await picture.receive(image("xyz8"), 3);
  picture.options = { palette: "color" };
  await picture.receive(image("bgr8"), 3);
  const fault = expect.stringContaining("unknown encoding “xyz8”");
  expect(reports).toEqual(["rgb8", fault, fault, "bgr8"]);
});
