/** Point clouds: sensor_msgs/PointCloud2 and PointCloud, which the worker prepares. */
import type { Send, Wanted } from "../../../messages/data_client";
import type { Delivery } from "../../../messages/feed";
import type { Fields } from "../../../messages/reader";
import { applied, type Transform, type Vector } from "../../../transforms";
import { DATATYPES, numberReader, type Packed } from "../cloud";
import type { Options, Report, Request } from "../cloud_messages";
import { type Palette, parseColor, percentiles } from "../colors";
import {
  firstProblems,
  type Header,
  type Hit,
  type Layer,
  type LayerContext,
  type Places,
  type Pointer,
  type Problems,
  type View,
} from "../layer";
import { matrixOf } from "../matrix";
import { corners, nearestPoint } from "../picking";
import { type Paint, renderer, Vertices } from "../renderer";

/** Clouds that are kept at most, however long they stay. */
const MAX_CLOUDS = 100;
/** The part of a new range of colours in the shown one, so that colours do not flicker. */
const SMOOTHING = 0.3;
/** One message. */
interface Cloud {
  readonly header: Header;
  readonly packed: Packed;
  readonly vertices: Vertices;
  readonly arrived: number;
  /** The lowest and the highest value that has a colour of its own. */
  range: readonly [number, number] | undefined;
}

export class PointCloud implements Layer {
  readonly #context: LayerContext;
  #clouds: Cloud[] = [];
  /** The shown range of colours, which follows that of the messages. */
  #range: readonly [number, number] | undefined;

  #send: Send<Request> | undefined;
  /** The options that the worker has. */
  #sent = "";

  constructor(context: LayerContext) {
    this.#context = context;
  }

  subscribe(
    { topic, type, throttle = 0 }: Wanted,
    receive: (message: Fields, delivery: Delivery) => void,
    fail: (why: string) => void,
  ): () => void {
    const options = this.#options();
    const request = { kind: "cloud", topic, type: type ?? "", throttle, options } as const;
    const send = this.#context.hub.open<Request, Report>(request, [], (report) => {
      if (report.kind === "fault") {
        fail(report.why);
        return;
      }
      const { message, isAgain, ...delivery } = report;
      try {
        if (isAgain) this.#replace(message.packed);
        else receive(message, { ...delivery, message });
      } finally {
        send({ kind: "taken" });
      }
    });
    this.#send = send;
    return () => {
      this.#send = undefined;
      send({ kind: "close" });
    };
  }

  clear(): void {
    this.close();
    this.#clouds = [];
  }

  /** Take a cloud that the worker has prepared. */
  receive({ header, packed }: Fields, now: number): void {
    const decay = Number(this.#context.settings.decay) * 1000;
    const kept = this.#clouds.filter(({ arrived }) => arrived > now - decay).slice(1 - MAX_CLOUDS);
    const old = this.#clouds.filter((each) => !kept.includes(each));
    // The memory of one that ends is that of the next.
    const vertices = old.pop()?.vertices ?? new Vertices();
    for (const cloud of old) cloud.vertices.close();
    const cloud = { header: header as Header, packed: packed as Packed, vertices };
    vertices.set(cloud.packed.data);
    this.#clouds = [...kept, { ...cloud, arrived: now, range: undefined }];
    this.#sendOptions(false);
  }

  update(): void {
    this.#range = undefined;
    for (const cloud of this.#clouds) cloud.range = undefined;
    // Other colours may need other bytes.
    this.#sendOptions(true);
  }

  /** What the worker has to know. */
  #options(): Options {
    const { color, field } = this.#context.settings;
    const most = Math.ceil(renderer.maxPoints / Math.max(1, this.#clouds.length));
    return { color, field, most };
  }

  /** Send other options to the worker; `isAgain`: it prepares the newest cloud again. */
  #sendOptions(isAgain: boolean): void {
    const options = this.#options();
    const text = JSON.stringify(options);
    if (text === this.#sent && !isAgain) return;
    this.#sent = text;
    this.#send?.({ kind: "options", options, isAgain });
  }

  /** Replace the newest cloud by one in other colours. */
  #replace(packed: Packed): void {
    const last = this.#clouds.at(-1);
    if (last === undefined) return;
    last.vertices.set(packed.data);
    this.#clouds = [...this.#clouds.slice(0, -1), { ...last, packed, range: undefined }];
    this.#context.redraw();
  }

  draw(view: View): void {
    const { settings } = this.#context;
    for (const cloud of this.#clouds) {
      const model = view.place(cloud.header);
      if (model === undefined) continue;
      const { packed, vertices } = cloud;
      const { count, stride, offset } = packed;
      const paint = this.#paint(cloud, model);
      const size = Number(settings.size);
      const every = packed.isThinned ? 1 : packed.every;
      renderer.points({ vertices, count, stride, offset, size, paint, every }, model);
    }
  }

  problems(places: Places): Problems {
    const warning = this.#clouds.at(-1)?.packed.fault ?? "";
    const located = this.#clouds.toReversed().map(({ header }) => places.locate(header));
    return firstProblems([{ error: "", warning }, ...located]);
  }

  #paint(cloud: Cloud, model: Transform): Paint {
    const { settings } = this.#context;
    const { paint } = cloud.packed;
    const palette = settings.palette as Palette;
    switch (paint.kind) {
      case "bgr":
        return paint;
      case "flat":
        return { kind: "flat", color: parseColor(String(settings.flat)) };
      case "number":
        return { ...paint, palette, ...this.#limits(cloud, undefined) };
      case "z": {
        // Heights are those of the fixed frame: cameras have z ahead.
        const m = matrixOf(model);
        const [x = 0, y = 0, z = 0, from = 0] = [m[2], m[6], m[10], m[14]];
        const limits = this.#limits(cloud, model);
        return { kind: "along", axis: { x, y, z }, from, palette, ...limits };
      }
    }
  }

  #limits(cloud: Cloud, model: Transform | undefined): { low: number; high: number } {
    const { settings } = this.#context;
    if (settings.isAuto !== true) return { low: Number(settings.low), high: Number(settings.high) };
    if (cloud.range === undefined) {
      cloud.range = percentiles(cloud.packed.count, valueReader(cloud.packed, model));
      const [low, high] = cloud.range;
      const [a, b] = this.#range ?? cloud.range;
      this.#range = [a + SMOOTHING * (low - a), b + SMOOTHING * (high - b)];
    }
    const [low, high] = this.#range ?? cloud.range;
    return { low, high };
  }

  facts(): string {
    const cloud = this.#clouds.at(-1);
    if (cloud === undefined) return "";
    const { field, every, total } = cloud.packed;
    const parts = [`${total.toLocaleString("en")} points`];
    if (field !== "") parts.push(`coloured by ${field}`);
    if (every > 1) parts.push(`every ${ordinal(every)} shown`);
    return parts.join(", ");
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const cloud = this.#clouds.at(-1);
    const model = cloud && view.place(cloud.header);
    if (cloud === undefined || model === undefined) return undefined;
    const { packed } = cloud;
    const near = nearestPoint(view, pointer, model, ...numbersOf(packed));
    if (near === undefined) return undefined;
    let text = `point ${near.index * (packed.isThinned ? packed.every : 1)}`;
    if (packed.paint.kind === "number") {
      const value = valueReader(packed, undefined)(near.index);
      text += `, ${packed.field} ${Number(value.toPrecision(5))}`;
    }
    return { distance: near.distance, place: near.place, text };
  }

  extent(view: View): Vector[] {
    const cloud = this.#clouds.at(-1);
    const model = cloud && view.place(cloud.header);
    return cloud === undefined || model === undefined
      ? []
      : corners(...numbersOf(cloud.packed), model);
  }

  close(): void {
    for (const { vertices } of this.#clouds) vertices.close();
  }
}

/** The coordinates of the points, and how many numbers are between them. */
function numbersOf({ data, stride, offset }: Packed): [numbers: Float32Array, step: number] {
  const at = data.byteOffset + offset;
  const length = Math.max(0, Math.floor((data.byteLength - offset) / 4));
  // Fields in a message are not aligned: a copy is.
  const numbers =
    at % 4 === 0
      ? new Float32Array(data.buffer, at, length)
      : new Float32Array(data.slice(offset, offset + 4 * length).buffer);
  return [numbers, stride / 4];
}

/** A function for the value of a point that its colour is for. */
function valueReader(packed: Packed, model: Transform | undefined): (index: number) => number {
  const { data, stride, offset, paint } = packed;
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  if (paint.kind === "number") {
    const datatype = DATATYPES.indexOf(paint.type);
    const read = numberReader(view, datatype, true);
    return (index) => read(index * stride + paint.offset);
  }
  return (index) => {
    const at = index * stride + offset;
    const [x, y, z] = [0, 4, 8].map((each) => view.getFloat32(at + each, true));
    const point = { x: x as number, y: y as number, z: z as number };
    return model === undefined ? point.z : applied(model, point).z;
  };
}

function ordinal(number: number): string {
  const suffix = ["st", "nd", "rd"][(number % 10) - 1];
  return `${number}${suffix === undefined || (number >= 11 && number <= 13) ? "th" : suffix}`;
}
