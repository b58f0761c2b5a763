/** Prepares point clouds for the graphics card: PointCloud2, whose bytes it takes as they are, and PointCloud. */
import type { Fields } from "../../messages/reader";
import { sizeOfCloud } from "../../messages/sizes";
import { bytes, floats } from "../../messages/values";
import type { Vector } from "../../transforms";
import type { NumberType } from "./renderer";

/** Bytes from one point to the next that WebGL allows. */
const MAX_STRIDE = 255;

/** Points as WebGL takes them. */
export interface Packed {
  readonly data: Uint8Array;
  readonly count: number;
  readonly stride: number;
  /** Before the first point's x, y and z, which are float32. */
  readonly offset: number;
  /** Where the colours come from. */
  readonly paint:
    | { readonly kind: "flat" | "z" }
    | { readonly kind: "bgr"; readonly offset: number }
    | { readonly kind: "number"; readonly offset: number; readonly type: NumberType };
  /** The field of the colours. */
  readonly field: string;
  /** Points of the message, of which every this many are drawn. */
  readonly total: number;
  readonly every: number;
  /** Whether the others are left out already. */
  readonly isThinned: boolean;
  /** What is wrong with the message, though there are points. */
  readonly fault: string;
}

/** What a field of sensor_msgs/PointField is, by its `datatype`: 1 to 8. */
export const DATATYPES = [
  "",
  "int8",
  "uint8",
  "int16",
  "uint16",
  "int32",
  "uint32",
  "float32",
  "float64",
] as const;
const SIZES = [0, 1, 1, 2, 2, 4, 4, 4, 8] as const;

interface PointField {
  readonly name: string;
  readonly offset: number;
  readonly datatype: number;
}

/** The choice of colours: a mode, and the name of a field. */
export interface Coloring {
  readonly color: unknown;
  readonly field: unknown;
}

/** The field of the colours; `undefined` for z and flat ones. */
function colorField(
  fields: readonly PointField[],
  { color, field }: Coloring,
): PointField | undefined {
  const named = (...names: unknown[]): PointField | undefined =>
    fields.find(({ name }) => names.includes(name));
  switch (color) {
    case "auto":
      return named("rgb", "rgba") ?? named("intensity", "i");
    case "rgb":
      return named("rgb", "rgba");
    case "field":
      return named(field);
    default:
      return undefined;
  }
}

/**
 * Prepare a sensor_msgs/PointCloud2: its own bytes if WebGL takes them, else others.
 *
 * WebGL wants numbers of 32 bits at multiples of 4 bytes, in the order of the processor's bytes.
 * `most` points are kept. Throws an `Error` that says what is wrong with the message.
 */
export function packCloud(message: Fields, coloring: Coloring, most: number): Packed {
  const { width, height, point_step: step, row_step: row } = message as Record<string, number>;
  const fields = message.fields as readonly PointField[];
  const [columns, rows, size] = [width ?? 0, height ?? 0, step ?? 0];
  const [x, y, z] = ["x", "y", "z"].map((axis) => {
    const field = fields.find(({ name }) => name === axis);
    if (field === undefined) {
      throw new Error(`no field ${axis}: there are ${fields.map(({ name }) => name).join(", ")}`);
    }
    return field;
  }) as [PointField, PointField, PointField];
  for (const { name, offset, datatype } of [x, y, z]) {
    if (datatype !== 7 && datatype !== 8) {
      throw new Error(`field ${name} must be float32 or float64, got ${typeName(datatype)}`);
    }
    if (offset + (SIZES[datatype] ?? 0) > size) {
      throw new Error(`field ${name} is at byte ${offset}, but points have ${size} bytes`);
    }
  }
  const data = bytes(message.data);
  const { rowSize, total, ...found } = sizeOfCloud(columns, rows, row ?? 0, size, data.length);
  let { fault } = found;
  const color = colorField(fields, coloring);
  const inside = color === undefined || color.offset + (SIZES[color.datatype] ?? 99) <= size;
  const field = color !== undefined && inside ? color : undefined;
  if (coloring.color === "rgb" && field === undefined) fault ||= "no field rgb or rgba";
  if (coloring.color === "field" && field === undefined) {
    fault ||= `no field ${coloring.field}: there are ${fields.map(({ name }) => name).join(", ")}`;
  }
  const isRgb = field !== undefined && (field.name === "rgb" || field.name === "rgba");
  const every = Math.max(1, Math.ceil(total / most));
  const isPlain =
    message.is_bigendian !== true &&
    rowSize === columns * size &&
    [x, y, z].every(({ datatype }) => datatype === 7) &&
    y.offset === x.offset + 4 &&
    z.offset === x.offset + 8 &&
    size % 4 === 0 &&
    x.offset % 4 === 0 &&
    size * every <= MAX_STRIDE &&
    (field === undefined ||
      (field.datatype !== 8 && field.offset % (SIZES[field.datatype] ?? 1) === 0));
  const common = { field: field?.name ?? "", total, every, fault };
  const plainPaint = (): Packed["paint"] => {
    if (field === undefined) return { kind: coloring.color === "flat" ? "flat" : "z" };
    if (isRgb) return { kind: "bgr", offset: field.offset };
    return { kind: "number", offset: field.offset, type: DATATYPES[field.datatype] as NumberType };
  };
  if (isPlain) {
    const paint = plainPaint();
    return {
      data,
      count: total,
      stride: size,
      offset: x.offset,
      paint,
      isThinned: false,
      ...common,
    };
  }
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const little = message.is_bigendian !== true;
  const count = Math.ceil(total / every);
  const out = new Float32Array(count * 4);
  const outBytes = new Uint8Array(out.buffer);
  const readers = [x, y, z].map(({ datatype }) => numberReader(view, datatype, little));
  const readColor = field === undefined ? undefined : numberReader(view, field.datatype, little);
  for (let index = 0; index < count; index += 1) {
    const point = index * every;
    const at = Math.floor(point / columns) * rowSize + (point % columns) * size;
    const to = index * 4;
    out[to] = readers[0]?.(at + x.offset) ?? 0;
    out[to + 1] = readers[1]?.(at + y.offset) ?? 0;
    out[to + 2] = readers[2]?.(at + z.offset) ?? 0;
    if (field === undefined) continue;
    if (isRgb) {
      const from = at + field.offset;
      for (let byte = 0; byte < 3; byte += 1) {
        outBytes[to * 4 + 12 + byte] = data[little ? from + byte : from + 3 - byte] ?? 0;
      }
    } else {
      out[to + 3] = readColor?.(at + field.offset) ?? 0;
    }
  }
  const plain = plainPaint();
  const paint: Packed["paint"] =
    plain.kind === "number"
      ? { kind: "number", offset: 12, type: "float32" }
      : plain.kind === "bgr"
        ? { kind: "bgr", offset: 12 }
        : plain;
  return { data: outBytes, count, stride: 16, offset: 0, paint, isThinned: true, ...common };
}

function typeName(datatype: number): string {
  return DATATYPES[datatype] || `datatype ${datatype}`;
}

export function numberReader(
  view: DataView,
  datatype: number,
  little: boolean,
): (at: number) => number {
  switch (datatype) {
    case 1:
      return (at) => view.getInt8(at);
    case 2:
      return (at) => view.getUint8(at);
    case 3:
      return (at) => view.getInt16(at, little);
    case 4:
      return (at) => view.getUint16(at, little);
    case 5:
      return (at) => view.getInt32(at, little);
    case 6:
      return (at) => view.getUint32(at, little);
    case 7:
      return (at) => view.getFloat32(at, little);
    default:
      return (at) => view.getFloat64(at, little);
  }
}

/** Prepare a cloud of one of the two types; `packCloud` says how. */
export function pack(message: Fields, coloring: Coloring, most: number): Packed {
  return "points" in message
    ? packOldCloud(message, coloring, most)
    : packCloud(message, coloring, most);
}

/** Prepare a sensor_msgs/PointCloud, as a PointCloud2 would be. */
function packOldCloud(message: Fields, coloring: Coloring, most: number): Packed {
  const points = message.points as readonly Vector[];
  const channels = message.channels as readonly { name: string; values: unknown }[];
  const fields = channels.map(({ name }) => ({ name, offset: 0, datatype: 7 }));
  const field = colorField(fields, coloring)?.name ?? "";
  const values = floats(channels.find(({ name }) => name === field)?.values);
  const every = Math.max(1, Math.ceil(points.length / most));
  const count = Math.ceil(points.length / every);
  const out = new Float32Array(count * 4);
  for (let index = 0; index < count; index += 1) {
    const { x, y, z } = points[index * every] as Vector;
    out.set([x, y, z, values[index * every] ?? Number.NaN], index * 4);
  }
  const isRgb = field === "rgb" || field === "rgba";
  const paint: Packed["paint"] =
    field === ""
      ? { kind: coloring.color === "flat" ? "flat" : "z" }
      : isRgb
        ? { kind: "bgr", offset: 12 }
        : { kind: "number", offset: 12, type: "float32" };
  const data = new Uint8Array(out.buffer);
  const layout = { data, count, stride: 16, offset: 0, paint, field };
  return { ...layout, total: points.length, every, isThinned: true, fault: "" };
}
