/**
 * What the text of one input means.
 *
 * A value is as JSON has it, but for what JSON numbers in a browser cannot hold: an integer beyond
 * 2^53 is its decimal digits, as a string.
 */
import { byteLength, bytesOf, type Field, kindOf, own, rangeOf, typeText } from "../types";

/** What is wrong, and where: the path is empty for the message itself. */
export interface Problem {
  readonly path: string;
  readonly text: string;
}

export type Reading = { readonly value: unknown } | { readonly problem: string };

const FLOAT32_MAX = 3.4028235677973366e38;
const NOT_A_NUMBER = /^[+-]?nan$/i;
const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const WHOLE = /^[+-]?(\d+|0x[\da-f]+)$/i;

/** An object whose fields may have any name, `__proto__` too. */
export function objectOf(entries: Iterable<readonly [string, unknown]>): Record<string, unknown> {
  return Object.fromEntries(entries);
}

/** What the text of one input means to a type that is no message. */
export function readText(type: string, text: string): Reading {
  const kind = kindOf(type);
  if (kind === "string") return { value: text };
  const trimmed = text.trim();
  switch (kind) {
    case "integer":
      return readInteger(type, trimmed);
    case "float":
      return readFloat(type, trimmed);
    case "bool":
      if (trimmed === "true" || trimmed === "false") return { value: trimmed === "true" };
      return { problem: `a bool is true or false, not ${quoted(text)}` };
    case "time":
    case "duration":
      return readTime(kind, trimmed);
    default:
      return { problem: `${type} is no single value` };
  }
}

/** What an input shows of a value that `readText` understands. */
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

function readInteger(type: string, text: string): Reading {
  const [low, high] = rangeOf(type) ?? [0n, 0n];
  const holds = `${type} holds ${low} to ${high}`;
  if (text === "") return { problem: `a whole number is missing: ${holds}` };
  if (!WHOLE.test(text)) return { problem: `${quoted(text)} is no whole number: ${holds}` };
  const negative = text.startsWith("-");
  const digits = BigInt(text.replace(/^[+-]/, ""));
  const number = negative ? -digits : digits;
  if (number < low || number > high) return { problem: `${text} does not fit: ${holds}` };
  const near = Number(number);
  return { value: Number.isSafeInteger(near) ? near : String(number) };
}

function readFloat(type: string, text: string): Reading {
  if (text === "") return { problem: "a number is missing" };
  // JSON has null for it.
  if (NOT_A_NUMBER.test(text)) return { value: null };
  if (!DECIMAL.test(text))
    return { problem: `${quoted(text)} is no number (1.5, -2e-3 and nan are)` };
  const number = Number(text);
  if (Math.abs(number) > (type === "float32" ? FLOAT32_MAX : Number.MAX_VALUE)) {
    return { problem: `${text} is too large for a ${type}` };
  }
  return { value: number };
}

function readTime(kind: "time" | "duration", text: string): Reading {
  if (kind === "time" && text === "now") return { value: "now" };
  const like = kind === "time" ? "seconds since 1970, a date, or now" : "seconds";
  const found = /^(-?)(\d+)(?:\.(\d{0,9}))?$/.exec(text);
  if (found === null) {
    const date = kind === "time" && /^\d{4}-/.test(text) ? Date.parse(text) : NaN;
    if (Number.isNaN(date)) return { problem: `${quoted(text)} is no ${kind}: write ${like}` };
    return inRange(kind, BigInt(date) * 1_000_000n, text);
  }
  const size = BigInt(found[2] ?? "0") * 1_000_000_000n + BigInt((found[3] ?? "").padEnd(9, "0"));
  return inRange(kind, found[1] === "-" ? -size : size, text);
}

/** That many nanoseconds as secs and nsecs. */
export function inRange(kind: "time" | "duration", total: bigint, text: string): Reading {
  let secs = total / 1_000_000_000n;
  // Nanoseconds are never negative: -1.5 s is -2 s and half a second.
  if (secs * 1_000_000_000n > total) secs -= 1n;
  const [low, high] = rangeOf(kind === "time" ? "uint32" : "int32") ?? [0n, 0n];
  if (secs < low || secs > high) {
    return { problem: `${text} does not fit: a ${kind} holds ${low} to ${high} seconds` };
  }
  return { value: { secs: Number(secs), nsecs: Number(total - secs * 1_000_000_000n) } };
}

/** Bytes as base64, or as a JSON list of numbers; gives base64. */
export function readBytes(field: Field, text: string): Reading {
  const trimmed = text.trim();
  let base64 = trimmed;
  if (trimmed.startsWith("[")) {
    let list: unknown;
    try {
      list = JSON.parse(trimmed);
    } catch {
      return { problem: "this list is no JSON: [1, 2, 255] is" };
    }
    const wrong = (list as unknown[]).find(
      (each) => !(typeof each === "number" && Number.isInteger(each) && each >= 0 && each <= 255),
    );
    if (wrong !== undefined)
      return { problem: `${JSON.stringify(wrong)} is no byte: those are 0 to 255` };
    base64 = btoa((list as number[]).map((each) => String.fromCharCode(each)).join(""));
  } else if (trimmed.length % 4 !== 0 || bytesOf(trimmed) === undefined) {
    return { problem: "bytes are base64 (AQID), or a list of numbers ([1, 2, 3])" };
  }
  const length = lengthProblem(field, byteLength(base64));
  return length === undefined ? { value: base64 } : { problem: length };
}

export function lengthProblem(field: Field, length: number): string | undefined {
  if (field.array <= 0 || length === field.array) return undefined;
  return `${typeText(field)} has ${field.array} elements, not ${length}`;
}

/**
 * A value from JSON text; throws a `SyntaxError`.
 *
 * Integers that a browser's numbers would round become strings of their digits.
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
