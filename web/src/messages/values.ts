/** The values in messages, whether these came serialized or as JSON. */
import { bytesOf, own } from "../types";

/** The elements of an array: a list, or a typed array; `undefined` for other values. */
export function elements(value: unknown): ArrayLike<unknown> | undefined {
  if (Array.isArray(value)) return value as unknown[];
  return ArrayBuffer.isView(value) ? (value as unknown as ArrayLike<unknown>) : undefined;
}

/** Bytes: those of an array, or of base64 text. */
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

/** A number as it was sent: `9007199254740993`, `-0`, `nan`, `inf`. */
export function numberText(value: number | bigint): string {
  if (typeof value === "bigint") return String(value);
  if (Number.isNaN(value)) return "nan";
  if (Math.abs(value) === Infinity) return value < 0 ? "-inf" : "inf";
  return Object.is(value, -0) ? "-0" : String(value);
}

/** A number with some digits after its point; one that is not finite as `numberText` has it. */
export function fixedText(value: number, digits: number): string {
  return Number.isFinite(value) ? value.toFixed(digits) : numberText(value);
}

/** The number at a path: times as seconds, booleans as 0 and 1; else `undefined`. */
export function numberAt(
  message: unknown,
  path: readonly (string | number)[],
): number | bigint | undefined {
  let value = message;
  for (const step of path) {
    if (typeof step === "string") value = own(value, step);
    else if (typeof value === "string") value = byteAt(value, step);
    else value = elements(value)?.[step];
  }
  if (typeof value === "number" || typeof value === "bigint") return value;
  if (typeof value === "boolean") return value ? 1 : 0;
  // JSON has `null` for numbers that are not finite.
  if (value === null) return Number.NaN;
  return secondsOf(value);
}

/** Elements of an array of numbers that are searched. */
const SEARCHED = 1000;

/** Whether a value has a text in one of its texts, in any case, or a number that is written so. */
export function hasText(value: unknown, text: string): boolean {
  if (typeof value === "string") return value.toLowerCase().includes(text.toLowerCase());
  if (typeof value === "number" || typeof value === "bigint") return numberText(value) === text;
  if (typeof value === "boolean") return String(value) === text;
  if (ArrayBuffer.isView(value) && value.byteLength > 8 * SEARCHED) return false;
  const list = elements(value);
  if (list !== undefined) return Array.from(list).some((each) => hasText(each, text));
  return Object.values(value ?? {}).some((each) => hasText(each, text));
}

/** A time or a duration in seconds; `undefined` for other values. */
export function secondsOf(value: unknown): number | undefined {
  const secs = own(value, "secs");
  const nsecs = own(value, "nsecs");
  return typeof secs === "number" && typeof nsecs === "number" ? secs + nsecs / 1e9 : undefined;
}

/** One byte of base64 text. Only the four letters that encode it are decoded. */
function byteAt(base64: string, index: number): number | undefined {
  const start = Math.floor(index / 3) * 4;
  return bytesOf(base64.slice(start, start + 4))?.[index % 3];
}

/**
 * A message as JSON that the hub reads back as it was: integers with all their digits, infinity as
 * `1e999`, NaN as `null`, bytes as base64.
 */
export function jsonText(value: unknown, indent = ""): string {
  if (typeof value === "bigint") return String(value);
  if (typeof value === "number") return jsonNumber(value);
  if (value instanceof Uint8Array) return JSON.stringify(base64(value));
  if (typeof value !== "object" || value === null) return JSON.stringify(value);
  const inner = `${indent}  `;
  const list = elements(value);
  const parts =
    list === undefined
      ? Object.entries(value).map(
          ([key, each]) => `${JSON.stringify(key)}: ${jsonText(each, inner)}`,
        )
      : Array.from(list, (each) => jsonText(each, inner));
  const [open, close] = list === undefined ? "{}" : "[]";
  if (parts.length === 0) return `${open}${close}`;
  return `${open}\n${parts.map((part) => inner + part).join(",\n")}\n${indent}${close}`;
}

function jsonNumber(value: number): string {
  if (Number.isNaN(value)) return "null";
  if (Math.abs(value) === Infinity) return value < 0 ? "-1e999" : "1e999";
  return Object.is(value, -0) ? "-0.0" : String(value);
}

function base64(data: Uint8Array): string {
  let text = "";
  for (const byte of data) text += String.fromCharCode(byte);
  return btoa(text);
}
