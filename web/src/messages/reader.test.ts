import { describe, expect, it } from "vitest";
import { typedef } from "../typedef.fixture";
import { bytesOf, type TypeDef } from "../types";
import { readDefinition } from "./definition";
import { makeReader } from "./reader";
import { elements } from "./values";

/** Bytes of little-endian numbers and texts. */
function bytes(...parts: (number[] | string)[]): Uint8Array {
  return Uint8Array.from(
    parts.flatMap((part) =>
      typeof part === "string" ? [...new TextEncoder().encode(part)] : part,
    ),
  );
}

const POINT = typedef("geometry_msgs/Point32", [
  ["x", "float32"],
  ["name", "string"],
]);
const PATH = typedef("x/Path", [
  ["stamp", "time"],
  ["points", "geometry_msgs/Point32", 0],
]);
const ONE = [0, 0, 128, 63];

describe("makeReader", () => {
  it("reads texts as they were sent, also those that are not UTF-8", () => {
    const read = makeReader([typedef("std_msgs/String", [["data", "string"]])]);
    const text = (...codes: number[]): unknown => read(bytes([codes.length, 0, 0, 0], codes)).data;
    expect(text(0x63, 0x61, 0x66, 0xe9)).toBe("caf\udce9");
    expect(text(0xef, 0xbb, 0xbf, 0x61)).toBe("\ufeffa");
    // A character that is cut off, one that is too long, half a pair, and valid ones around them.
    expect(text(0xc3, 0xbc, 0xe2, 0x82, 0x61)).toBe("ü\udce2\udc82a");
    expect(text(0xc0, 0x80, 0xed, 0xa0, 0x80, 0xf0, 0x9f, 0x98, 0x80)).toBe(
      "\udcc0\udc80\udced\udca0\udc80😀",
    );
  });

  it("reads nested messages, texts and times", () => {
    const read = makeReader([PATH, POINT]);
    const data = bytes(
      [1, 0, 0, 0, 2, 0, 0, 0],
      [1, 0, 0, 0],
      ONE,
      [3, 0, 0, 0],
      "übi".slice(0, 2),
    );
    expect(read(data)).toEqual({
      stamp: { secs: 1, nsecs: 2 },
      points: [{ x: 1, name: "üb" }],
    });
  });

  it("reads arrays of numbers at any offset", () => {
    const read = makeReader([
      typedef("x/All", [
        ["flag", "bool"],
        ["ranges", "float32", 0],
        ["fixed", "int16", 2],
        ["raw", "uint8", 0],
        ["flags", "bool", 2],
        ["large", "int64"],
      ]),
    ]);
    const data = bytes(
      [1],
      [1, 0, 0, 0],
      ONE,
      [255, 255, 2, 0],
      [2, 0, 0, 0, 7, 8],
      [1, 0],
      [...[255, 255, 255, 255, 255, 255, 255, 255]],
    );
    for (const offset of [0, 1, 2, 3]) {
      const moved = new Uint8Array(data.length + offset);
      moved.set(data, offset);
      expect(read(moved.subarray(offset))).toEqual({
        flag: true,
        ranges: Float32Array.of(1),
        fixed: Int16Array.of(-1, 2),
        raw: Uint8Array.of(7, 8),
        flags: [true, false],
        large: -1n,
      });
    }
  });

  it.each([
    ["too few bytes", [1, 0, 0, 0, 2, 0, 0]],
    ["too many bytes", [1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 9]],
    ["an impossible length", [1, 0, 0, 0, 2, 0, 0, 0, 255, 255, 255, 255]],
    ["an impossible text", [1, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, ...ONE, 255, 255, 255, 255]],
  ])("refuses %s", (_, data) => {
    expect(() => makeReader([PATH, POINT])(Uint8Array.from(data))).toThrow(RangeError);
  });

  it("bounds arrays of empty messages", () => {
    const read = makeReader([typedef("x/A", [["all", "x/Empty", 0]]), typedef("x/Empty", [])]);
    expect(read(bytes([2, 0, 0, 0]))).toEqual({ all: [{}, {}] });
    expect(() => read(bytes([255, 255, 255, 255]))).toThrow(RangeError);
  });

  it("refuses definitions that are not complete", () => {
    expect(() => makeReader([PATH])).toThrow("geometry_msgs/Point32 is missing");
    expect(() => makeReader([])).toThrow("no definition");
    expect(() => makeReader([typedef("x/A", [["a", "x/A"]])])).toThrow("contains itself");
  });
});

/** Messages that the hub has serialized, which tests/web/test_reader.py writes. */
interface Case {
  typedefs: TypeDef[];
  definition: string;
  serialized: string;
  values: unknown;
}

/** The module with the cases; none but in that test. */
const file = import.meta.env.VITE_READER_CASES as string | undefined;
const { cases } = file ? ((await import(file)) as { cases: Case[] }) : { cases: [] };

describe.runIf(file)("every type of the hub", () => {
  it.each(cases.map((each) => [each.typedefs[0]?.type ?? "", each] as const))("%s", (_, each) => {
    const data = bytesOf(each.serialized) ?? new Uint8Array();
    const [{ type } = { type: "" }] = each.typedefs;
    const definitions = readDefinition(type, each.definition);
    for (const { fieldnames, fieldtypes, fieldarraylen, ...found } of definitions) {
      const known = each.typedefs.find((def) => def.type === found.type);
      expect(known).toMatchObject({ fieldnames, fieldtypes, fieldarraylen });
    }
    const found = makeReader(definitions)(data);
    expect(plain(found)).toEqual(each.values);
    for (const end of [data.length - 1, data.length + 1]) {
      const other = new Uint8Array(Math.max(0, end));
      other.set(data.subarray(0, other.length));
      if (other.length !== data.length) expect(() => makeReader(each.typedefs)(other)).toThrow();
    }
  });
});

/** Values as in that test: integers beyond those that are exact in JavaScript are texts. */
function plain(value: unknown): unknown {
  if (typeof value === "bigint")
    return Number.isSafeInteger(Number(value)) ? Number(value) : String(value);
  if (value instanceof Uint8Array)
    return btoa(Array.from(value, (each) => String.fromCharCode(each)).join(""));
  const list = elements(value);
  if (list !== undefined) return Array.from(list, plain);
  if (typeof value !== "object" || value === null) return value;
  return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, plain(each)]));
}
