/**
 * Parses the text of inputs.
 *
 * Values are those of JSON, except integers beyond 2^53, which browsers would round: these are
 * strings of their decimal digits.
 */
import { byteLength, bytesOf, type Field, kindOf, own, rangeOf, typeText } from "../types";

/** A problem and its path, which is empty for the message itself. */
export interface Problem {
  readonly path: string;
  readonly text: string;
}

export type Result = { readonly value: unknown } | { readonly problem: string };

const FLOAT32_MAX = 3.4028235677973366e38;
const NOT_A_NUMBER = /^[+-]?nan$/i;
const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const WHOLE = /^[+-]?(\d+|0x[\da-f]+)$/i;

/** An object with fields of any name, even `__proto__`. */
export function objectOf(entries: Iterable<readonly [string, unknown]>): Record<string, unknown> {
  return Object.fromEntries(entries);
}

/** Parse the text of an input for a value of a type that is not a message. */
export function parseText(type: string, text: string): Result {
  const kind = kindOf(type);
  if (kind === "string") return { value: text };
  const trimmed = text.trim();
  switch (kind) {
    case "integer":
      return parseInteger(type, trimmed);
    case "float":
      return parseNumber(type, trimmed);
    case "bool":
      if (trimmed === "true" || trimmed === "false") return { value: trimmed === "true" };
      return { problem: `expected true or false, got ${quoted(text)}` };
    case "time":
    case "duration":
      return parseTime(kind, trimmed);
    default:
      return { problem: `${type} is not a single value` };
  }
}

/** The text of a value, from which `parseText` gets it back. */
export function textOf(value: unknown): string {
  if (value === null) return "nan";
  const secs = own(value, "secs");
  const nsecs = own(value, "nsecs");
  if (typeof secs === "number" && typeof nsecs === "number") {
    const total = BigInt(secs) * 1_000_000_000n + BigInt(nsecs);
    const size = total < 0n ? -total : total;
    const fraction = String(size % 1_000_000_000n)
      .padStart(9, "0")
      .replace(/0+$/, "");
    return `${total < 0n ? "-" : ""}${size / 1_000_000_000n}${fraction && `.${fraction}`}`;
  }
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

function parseInteger(type: string, text: string): Result {
  const [low, high] = rangeOf(type) ?? [0n, 0n];
  const expected = `${type} (${low} to ${high})`;
  if (text === "") return { problem: `missing integer for ${expected}` };
  if (!WHOLE.test(text))
    return { problem: `${quoted(text)} is not an integer; expected ${expected}` };
  const negative = text.startsWith("-");
  const digits = BigInt(text.replace(/^[+-]/, ""));
  const number = negative ? -digits : digits;
  if (number < low || number > high) return { problem: `${text} is out of range for ${expected}` };
  const near = Number(number);
  return { value: Number.isSafeInteger(near) ? near : String(number) };
}

function parseNumber(type: string, text: string): Result {
  if (text === "") return { problem: "missing number" };
  // JSON has null for nan.
  if (NOT_A_NUMBER.test(text)) return { value: null };
  if (!DECIMAL.test(text))
    return { problem: `${quoted(text)} is not a number; examples: 1.5, -2e-3, nan` };
  const number = Number(text);
  if (Math.abs(number) > (type === "float32" ? FLOAT32_MAX : Number.MAX_VALUE)) {
    return { problem: `${text} is too large for a ${type}` };
  }
  return { value: number };
}

function parseTime(kind: "time" | "duration", text: string): Result {
  if (kind === "time" && text === "now") return { value: "now" };
  const expected = kind === "time" ? "seconds since 1970, a date, or now" : "seconds";
  const found = /^(-?)(\d+)(?:\.(\d{0,9}))?$/.exec(text);
  if (found === null) {
    const date = kind === "time" && /^\d{4}-/.test(text) ? Date.parse(text) : NaN;
    if (Number.isNaN(date))
      return { problem: `${quoted(text)} is not a ${kind}; expected ${expected}` };
    return timeFromNanoseconds(kind, BigInt(date) * 1_000_000n, text);
  }
  const size = BigInt(found[2] ?? "0") * 1_000_000_000n + BigInt((found[3] ?? "").padEnd(9, "0"));
  return timeFromNanoseconds(kind, found[1] === "-" ? -size : size, text);
}

/** Convert nanoseconds to secs and nsecs; `text` names the value in a problem. */
export function timeFromNanoseconds(
  kind: "time" | "duration",
  total: bigint,
  text: string,
): Result {
  let secs = total / 1_000_000_000n;
  // Nanoseconds are never negative: -1.5 s is -2 s and half a second.
  if (secs * 1_000_000_000n > total) secs -= 1n;
  const [low, high] = rangeOf(kind === "time" ? "uint32" : "int32") ?? [0n, 0n];
  if (secs < low || secs > high) {
    return { problem: `${text} is out of range for ${kind} (${low} to ${high} seconds)` };
  }
  return { value: { secs: Number(secs), nsecs: Number(total - secs * 1_000_000_000n) } };
}

/** Parse bytes, written as base64 or as a JSON list of numbers; the value is base64. */
export function parseBytes(field: Field, text: string): Result {
  const trimmed = text.trim();
  let base64 = trimmed;
  if (trimmed.startsWith("[")) {
    let list: unknown;
    try {
      list = JSON.parse(trimmed);
    } catch {
      return { problem: "invalid list; example: [1, 2, 255]" };
    }
    const wrong = (list as unknown[]).find(
      (each) => !(typeof each === "number" && Number.isInteger(each) && each >= 0 && each <= 255),
    );
    if (wrong !== undefined) return { problem: `${JSON.stringify(wrong)} is not a byte (0-255)` };
    base64 = btoa((list as number[]).map((each) => String.fromCharCode(each)).join(""));
  } else if (trimmed.length % 4 !== 0 || bytesOf(trimmed) === undefined) {
    return { problem: "expected bytes as base64 (AQID) or as a list ([1, 2, 3])" };
  }
  const length = lengthProblem(field, byteLength(base64));
  return length === undefined ? { value: base64 } : { problem: length };
}

export function lengthProblem(field: Field, length: number): string | undefined {
  if (field.array <= 0 || length === field.array) return undefined;
  return `expected ${field.array} elements for ${typeText(field)}, got ${length}`;
}

/**
 * Parse JSON text; throws a `SyntaxError`.
 *
 * Integers that browsers would round become strings of their digits.
 */
export function parseJson(text: string): unknown {
  const kept = text.replace(/"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g, (token) =>
    /^-?\d+$/.test(token) && !Number.isSafeInteger(Number(token)) ? `"${token}"` : token,
  );
  return JSON.parse(kept) as unknown;
}

function quoted(text: string): string {
  return text.length > 40 ? `“${text.slice(0, 40)}…”` : `“${text}”`;
}
