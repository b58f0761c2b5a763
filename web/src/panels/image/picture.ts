/** Draws the newest image of a topic on a canvas; it runs in the worker. */
import type { Fields } from "../../messages/reader";
import { checkPicture } from "../../messages/sizes";
import { bytesOf } from "../../types";
import { isDeepPng, readDeepPng } from "./deep_png";
import { cellText, type Grid, gridPixels, isGrid, readGrid } from "./grid";
import { type Limits, type Options, type RawImage, toPixels, valueText } from "./pixels";

/** What the page shows of the newest image. */
export interface PictureState {
  /** The images that have been drawn. */
  readonly shown: number;
  readonly width: number;
  readonly height: number;
  /** The encoding, or the format of a compressed image. */
  readonly encoding: string;
  /** On the way here. */
  readonly bytes: number;
  /** When the image was made, in ms since 1970; 0 if it does not say so. */
  readonly stamp: number;
  /** When it was drawn, in ms since 1970. */
  readonly drawn: number;
  /** The numbers that are black and white, if the image has such. */
  readonly limits: Limits | undefined;
}

/** Bytes before the PNG of compressedDepth: a format, and the two numbers of its quantization. */
const DEPTH_HEAD = 12;
/** The kinds of compressed images, by their first bytes. */
const KINDS: readonly (readonly [type: string, start: readonly number[]])[] = [
  ["image/jpeg", [0xff, 0xd8]],
  ["image/png", [0x89, 0x50, 0x4e, 0x47]],
  ["image/webp", [0x52, 0x49, 0x46, 0x46]],
];

/** An image to be drawn. */
interface Waiting {
  readonly message: Fields;
  readonly size: number;
  done(): void;
}

/** An image that has been decoded. */
interface Drawing {
  readonly width: number;
  readonly height: number;
  /** The encoding, or what is known of it. */
  readonly encoding: string;
  /** Draw it on a canvas of its size; return the limits of its numbers, if it has such. */
  draw(context: OffscreenCanvasRenderingContext2D, options: Options): Limits | undefined;
  /** The value of a pixel as text; empty, or missing, if the canvas has it. */
  valueAt?(x: number, y: number): string;
}

export class Picture {
  readonly canvas: OffscreenCanvas;
  readonly #context: OffscreenCanvasRenderingContext2D | null;
  readonly #report: (state: PictureState) => void;
  readonly #fail: (why: string) => void;
  #options: Options = { palette: "grey" };
  #isBusy = false;
  #next: Waiting | undefined;
  #newest: Waiting | undefined;
  #drawing: Drawing | undefined;
  #shown = 0;

  constructor(
    canvas: OffscreenCanvas,
    report: (state: PictureState) => void,
    fail: (why: string) => void,
  ) {
    this.canvas = canvas;
    // Values under the pointer are read from the canvas.
    this.#context = canvas.getContext("2d", { willReadFrequently: true });
    this.#report = report;
    this.#fail = fail;
  }

  /** Change how numbers are shown, of the newest image, too. */
  set options(options: Options) {
    this.#options = options;
    if (this.#newest === undefined || this.#next !== undefined) return;
    void this.receive(this.#newest.message, this.#newest.size);
  }

  /**
   * Draw an image as soon as the one before is drawn; only the newest waits.
   *
   * Resolves once it is drawn, or left out.
   */
  receive(message: Fields, size: number): Promise<void> {
    return new Promise((done) => {
      this.#next?.done();
      this.#next = { message, size, done };
      if (!this.#isBusy) void this.#drawAll();
    });
  }

  /** The value of a pixel as text; empty if there is none. */
  valueAt(x: number, y: number): string {
    const { width, height } = this.canvas;
    if (this.#shown === 0 || x < 0 || y < 0 || x >= width || y >= height) return "";
    const text = this.#drawing?.valueAt?.(x, y) ?? "";
    if (text !== "") return text;
    const [red, green, blue] = this.#context?.getImageData(x, y, 1, 1).data ?? [];
    return `rgb ${red} ${green} ${blue}`;
  }

  async #drawAll(): Promise<void> {
    this.#isBusy = true;
    for (let next = this.#next; next !== undefined; next = this.#next) {
      this.#next = undefined;
      // Also if it cannot be drawn: what is shown with other colours then is its fault.
      this.#newest = next;
      try {
        await this.#draw(next.message, next.size);
      } catch (error) {
        this.#fail((error as Error).message);
      } finally {
        next.done();
      }
    }
    this.#isBusy = false;
  }

  async #draw(message: Fields, bytes: number): Promise<void> {
    const drawing = await decode(message);
    const { width, height, encoding } = drawing;
    this.#resize(width, height);
    const limits = this.#context && drawing.draw(this.#context, this.#options);
    this.#drawing = drawing;
    this.#shown += 1;
    const stamp = stampOf(message);
    const state = { shown: this.#shown, width, height, encoding, bytes, stamp };
    this.#report({ ...state, limits: limits ?? undefined, drawn: Date.now() });
  }

  #resize(width: number, height: number): void {
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }
}

/** Decode an Image, a CompressedImage or an OccupancyGrid; bytes are base64 if it came as JSON. */
async function decode(message: Fields): Promise<Drawing> {
  if (isGrid(message)) return ofGrid(readGrid(message));
  const data = typeof message.data === "string" ? bytesOf(message.data) : message.data;
  if (!(data instanceof Uint8Array)) throw new Error("the message has no image");
  if (typeof message.format !== "string") return ofRaw({ ...message, data } as unknown as RawImage);
  const decoded = await decompress(message.format, data);
  const format = message.format || "compressed";
  return "close" in decoded ? ofBitmap(decoded, format) : { ...ofRaw(decoded), encoding: format };
}

function ofRaw(image: RawImage): Drawing {
  const { width, height, encoding } = image;
  return {
    width,
    height,
    encoding,
    draw(context, options) {
      const { pixels, limits } = toPixels(image, options);
      context.putImageData(pixels, 0, 0);
      return limits;
    },
    valueAt: (x, y) => valueText(image, x, y),
  };
}

function ofBitmap(bitmap: ImageBitmap, encoding: string): Drawing {
  const { width, height } = bitmap;
  return {
    width,
    height,
    encoding,
    draw(context) {
      context.drawImage(bitmap, 0, 0);
      bitmap.close();
      return undefined;
    },
  };
}

function ofGrid(grid: Grid): Drawing {
  const { width, height, resolution } = grid;
  return {
    width,
    height,
    encoding: `cells of ${Number(resolution.toPrecision(4))} m`,
    draw(context) {
      context.putImageData(gridPixels(grid), 0, 0);
      return undefined;
    },
    valueAt: (x, y) => cellText(grid, x, y),
  };
}

async function decompress(format: string, data: Uint8Array): Promise<RawImage | ImageBitmap> {
  if (format.includes("compressedDepth")) return await depths(format, data);
  if (isDeepPng(data)) {
    const deep = await readDeepPng(data);
    return { ...deep, encoding: "mono16", is_bigendian: 1, step: 2 * deep.width };
  }
  // The format is not trusted: some write "rgb8; jpeg compressed bgr8", others "jpg".
  const type = KINDS.find(([, start]) => start.every((byte, at) => data[at] === byte))?.[0];
  if (type === undefined) {
    const kinds = KINDS.map(([name]) => name.replace("image/", "").toUpperCase()).join(", ");
    throw new Error(`the data of the format “${format}” is none of ${kinds}`);
  }
  checkPicture(data);
  try {
    return await createImageBitmap(new Blob([data as Uint8Array<ArrayBuffer>], { type }));
  } catch {
    throw new Error(`the browser cannot decode this ${type.replace("image/", "").toUpperCase()}`);
  }
}

/** Decode the depths of compressed_depth_image_transport: millimeters, or quantized inverses. */
async function depths(format: string, data: Uint8Array): Promise<RawImage> {
  const png = data.subarray(DEPTH_HEAD);
  if (!isDeepPng(png))
    throw new Error(`the depths of the format “${format}” are no PNG of 16 bits`);
  const deep = await readDeepPng(png);
  if (!format.startsWith("32FC1")) {
    return { ...deep, encoding: "16UC1", is_bigendian: 1, step: 2 * deep.width };
  }
  const head = new DataView(data.buffer, data.byteOffset, DEPTH_HEAD);
  const [a, b] = [head.getFloat32(4, true), head.getFloat32(8, true)];
  const numbers = new DataView(deep.data.buffer);
  const meters = Float32Array.from({ length: deep.width * deep.height }, (_, at) => {
    const number = numbers.getUint16(2 * at);
    return number === 0 ? Number.NaN : a / (number - b);
  });
  const { width, height } = deep;
  const bytes = new Uint8Array(meters.buffer);
  return { width, height, data: bytes, encoding: "32FC1", is_bigendian: 0, step: 4 * width };
}

function stampOf({ header }: Fields): number {
  const { secs = 0, nsecs = 0 } = ((header as Fields | undefined)?.stamp ?? {}) as {
    secs?: number;
    nsecs?: number;
  };
  return secs * 1000 + nsecs / 1e6;
}
