import { describe, expect, it } from "vitest";
import { typedef } from "../typedef.fixture";
import { bytesOf, type TypeDef } from "../types";
import { makeReader } from "./reader";

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
  serialized: string;
  values: unknown;
}

/** The module with the cases; none but in that test. */
const file = import.meta.env.VITE_READER_CASES as string | undefined;
const { cases } = file ? ((await import(file)) as { cases: Case[] }) : { cases: [] };

describe.runIf(file)("every type of the hub", () => {
  it.each(cases.map((each) => [each.typedefs[0]?.type ?? "", each] as const))("%s", (_, each) => {
    const data = bytesOf(each.serialized) ?? new Uint8Array();
    const found = makeReader(each.typedefs)(data);
    expect(JSON.parse(JSON.stringify(found, plain))).toEqual(each.values);
    for (const end of [data.length - 1, data.length + 1]) {
      const other = new Uint8Array(Math.max(0, end));
      other.set(data.subarray(0, other.length));
      if (other.length !== data.length) expect(() => makeReader(each.typedefs)(other)).toThrow();
    }
  });
});

/** Values as the hub's JSON has them. */
function plain(_key: string, value: unknown): unknown {
  if (typeof value === "bigint") return Number(value);
  if (value instanceof Uint8Array) return btoa(String.fromCharCode(...value));
  if (ArrayBuffer.isView(value)) return Array.from(value as unknown as ArrayLike<unknown>);
  return value;
}
