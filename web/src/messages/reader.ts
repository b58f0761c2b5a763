/**
 * Reads messages in ROS 1's serialization (http://wiki.ros.org/msg), and in ROS 2's, which is CDR:
 * values are aligned to their sizes, and texts end with a zero.
 *
 * A reader is made from the definition of a type, as functions for its fields: the page's security
 * policy forbids making code from text.
 */

import { decodeText } from "../text";
import type { Definition } from "./definition";

/**
 * A message. Numbers of 64 bits are bigints; arrays of numbers are typed arrays; texts that are not
 * UTF-8 are as `decodeText` makes them.
 */
export type Fields = Record<string, unknown>;
export type Reader = (bytes: Uint8Array) => Fields;

type Read = (cursor: Cursor) => unknown;

interface Scalar {
  readonly size: number;
  read(view: DataView, at: number): unknown;
  /** The class of an array of these; none for booleans. */
  readonly array?: TypedArrayClass;
}

type TypedArrayClass =
  | Int8ArrayConstructor
  | Uint8ArrayConstructor
  | Int16ArrayConstructor
  | Uint16ArrayConstructor
  | Int32ArrayConstructor
  | Uint32ArrayConstructor
  | Float32ArrayConstructor
  | Float64ArrayConstructor
  | BigInt64ArrayConstructor
  | BigUint64ArrayConstructor;

const INT8: Scalar = { size: 1, read: (view, at) => view.getInt8(at), array: Int8Array };
const UINT8: Scalar = { size: 1, read: (view, at) => view.getUint8(at), array: Uint8Array };

const SCALARS = new Map<string, Scalar>([
  ["bool", { size: 1, read: (view, at) => view.getUint8(at) !== 0 }],
  ["int8", INT8],
  ["byte", INT8],
  ["uint8", UINT8],
  ["char", UINT8],
  ["int16", { size: 2, read: (view, at) => view.getInt16(at, true), array: Int16Array }],
  ["uint16", { size: 2, read: (view, at) => view.getUint16(at, true), array: Uint16Array }],
  ["int32", { size: 4, read: (view, at) => view.getInt32(at, true), array: Int32Array }],
  ["uint32", { size: 4, read: (view, at) => view.getUint32(at, true), array: Uint32Array }],
  ["int64", { size: 8, read: (view, at) => view.getBigInt64(at, true), array: BigInt64Array }],
  ["uint64", { size: 8, read: (view, at) => view.getBigUint64(at, true), array: BigUint64Array }],
  ["float32", { size: 4, read: (view, at) => view.getFloat32(at, true), array: Float32Array }],
  ["float64", { size: 8, read: (view, at) => view.getFloat64(at, true), array: Float64Array }],
  [
    "time",
    {
      size: 8,
      read: (view, at) => ({ secs: view.getUint32(at, true), nsecs: view.getUint32(at + 4, true) }),
    },
  ],
  [
    "duration",
    {
      size: 8,
      read: (view, at) => ({ secs: view.getInt32(at, true), nsecs: view.getInt32(at + 4, true) }),
    },
  ],
]);

/** Bytes before a message in CDR: the kind of CDR, and options. */
const CDR_HEAD = 4;
/** The second byte of these, for values whose lowest byte comes first. */
const CDR_LITTLE_ENDIAN = 1;

/** Most elements of an array whose elements take no bytes. */
const MAX_EMPTY = 65_536;

/** The place in a message up to which it has been read. */
class Cursor {
  readonly bytes: Uint8Array;
  readonly view: DataView;
  at: number;
  /** Where alignment begins; none without CDR. */
  readonly origin: number | undefined;

  constructor(bytes: Uint8Array, isCdr: boolean) {
    this.bytes = bytes;
    this.origin = isCdr ? CDR_HEAD : undefined;
    this.at = this.origin ?? 0;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  /** Go over some bytes; return where they begin. Throws a `RangeError` if there are fewer. */
  skip(size: number): number {
    const start = this.at;
    if (size > this.bytes.length - start) {
      throw new RangeError(`the message ends early: ${size} bytes expected at ${start}`);
    }
    this.at = start + size;
    return start;
  }

  /** Go on to where a value of some bytes may begin. */
  align(size: number): void {
    if (this.origin !== undefined) this.at += (this.origin - this.at) & (size - 1);
  }

  length(): number {
    this.align(4);
    return this.view.getUint32(this.skip(4), true);
  }
}

/**
 * Make a reader of the first type in a list of definitions.
 *
 * It throws a `RangeError` for bytes that are not a message of this type. Arrays of bytes, and others
 * that are aligned, are views of the message. Throws an `Error` if the definition of a type is
 * missing.
 */
export function makeReader(definitions: readonly Definition[], isCdr = false): Reader {
  const known = new Map(definitions.map((def) => [def.type, def]));
  const [first] = definitions;
  if (first === undefined) throw new Error("no definition");
  const { read } = messageReader(first.type, known, []);
  return (bytes) => {
    const cursor = new Cursor(bytes, isCdr);
    if (isCdr && bytes[1] !== CDR_LITTLE_ENDIAN)
      throw new RangeError("only CDR of version 1, little-endian, can be read");
    const message = read(cursor) as Fields;
    // In CDR an empty message has a byte, and padding may follow.
    if (cursor.at !== bytes.length && !isCdr) {
      throw new RangeError(`the message has ${bytes.length - cursor.at} bytes too many`);
    }
    return message;
  };
}

/** A function that reads a type, and the fewest bytes that a value has. */
interface Part {
  readonly read: Read;
  readonly least: number;
}

function messageReader(type: string, known: Map<string, Definition>, above: string[]): Part {
  const def = known.get(type);
  if (def === undefined) throw new Error(`the definition of ${type} is missing`);
  if (above.includes(type)) throw new Error(`${type} contains itself`);
  const within = [...above, type];
  const parts = def.fieldnames.map((name, at) => {
    const element = elementReader(def.fieldtypes[at] ?? "", known, within);
    const array = def.fieldarraylen[at] ?? -1;
    return [name, array < 0 ? element : arrayReader(element, array)] as const;
  });
  return {
    least: parts.reduce((sum, [, { least }]) => sum + least, 0),
    read(cursor) {
      // A field may be called __proto__.
      const message: Fields = Object.create(null) as Fields;
      for (const [name, { read }] of parts) message[name] = read(cursor);
      return message;
    },
  };
}

interface Element extends Part {
  readonly scalar?: Scalar;
}

function elementReader(type: string, known: Map<string, Definition>, above: string[]): Element {
  const scalar = SCALARS.get(type);
  if (scalar !== undefined) {
    const { size, read } = scalar;
    const align = alignmentOf(scalar);
    const readOne = (cursor: Cursor): unknown => {
      cursor.align(align);
      return read(cursor.view, cursor.skip(size));
    };
    return { read: readOne, least: size, scalar };
  }
  if (type === "string" || type === "wstring") return { read: readString, least: 4 };
  return messageReader(type, known, above);
}

/** Times are of two numbers. */
function alignmentOf({ size, array }: Scalar): number {
  return array === undefined ? Math.min(size, 4) : size;
}

function readString(cursor: Cursor): string {
  const start = cursor.skip(cursor.length());
  const end = cursor.origin === undefined ? cursor.at : Math.max(start, cursor.at - 1);
  return decodeText(cursor.bytes.subarray(start, end));
}

/** Read arrays; `length` is 0 for those of any length. */
function arrayReader({ read, least, scalar }: Element, length: number): Part {
  const count = length === 0 ? (cursor: Cursor) => cursor.length() : () => length;
  const start = length === 0 ? 4 : length * least;
  const { array, size } = scalar ?? {};
  if (array !== undefined && size !== undefined) {
    return { least: start, read: (cursor) => numbers(cursor, array, size, count(cursor)) };
  }
  return {
    least: start,
    read(cursor) {
      const found = count(cursor);
      // A wrong length must not take memory that the message's own size does not explain.
      const most = least === 0 ? MAX_EMPTY : (cursor.bytes.length - cursor.at) / least;
      if (found > most) throw new RangeError(`the message ends early: ${found} elements expected`);
      return Array.from({ length: found }, () => read(cursor));
    },
  };
}

function numbers(cursor: Cursor, array: TypedArrayClass, size: number, count: number): unknown {
  // An empty array has no padding.
  if (count > 0) cursor.align(size);
  const start = cursor.skip(count * size);
  const { buffer, byteOffset } = cursor.bytes;
  const at = byteOffset + start;
  if (at % size === 0) return new array(buffer as ArrayBuffer, at, count);
  return new array(buffer.slice(at, at + count * size) as ArrayBuffer);
}
