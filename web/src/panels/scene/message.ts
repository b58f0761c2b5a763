/** Parts of messages, from serialized ones as from JSON. */
import type { Quaternion, Vector } from "../../transforms";
import { bytesOf } from "../../types";

/** A geometry_msgs/Pose. */
export interface Pose {
  readonly position: Vector;
  readonly orientation: Quaternion;
}

/** Bytes: an array, or base64 text. */
export function bytes(value: unknown): Uint8Array {
  if (value instanceof Uint8Array) return value;
  if (value instanceof Int8Array) {
    return new Uint8Array(value.buffer, value.byteOffset, value.byteLength);
  }
  if (typeof value === "string") return bytesOf(value) ?? new Uint8Array();
  return Uint8Array.from(Array.isArray(value) ? (value as number[]) : []);
}

/** Numbers: an array, or a list in which `null` stands for NaN. */
export function floats(value: unknown): Float32Array {
  if (value instanceof Float32Array) return value;
  if (!Array.isArray(value)) return Float32Array.from((value ?? []) as ArrayLike<number>);
  return Float32Array.from(value, (each) => (each === null ? Number.NaN : Number(each)));
}
