import { expect, it } from "vitest";
import { append } from "../lists";
import { readDefinition } from "./definition";
import { makeReader } from "./reader";

/** Values after the head of CDR, each aligned to its size. */
function cdr(...values: readonly (readonly [size: number, value: number] | string)[]): Uint8Array {
  const bytes: number[] = [];
  const add = (size: number, value: number): void => {
    while (bytes.length % size !== 0) bytes.push(0xee);
    const view = new DataView(new ArrayBuffer(8));
    if (size === 8) view.setFloat64(0, value, true);
    else view.setUint32(0, value, true);
    append(bytes, new Uint8Array(view.buffer, 0, size));
  };
  for (const each of values) {
    if (typeof each !== "string") add(...each);
    else {
      add(4, each.length + 1);
      append(bytes, new TextEncoder().encode(`${each}\0`));
    }
  }
  return new Uint8Array([0, 1, 0, 0, ...bytes]);
}

function read(definition: string, bytes: Uint8Array): Record<string, unknown> {
  return { ...makeReader(readDefinition("a/A", definition), true)(bytes) };
}

it("values of CDR are aligned from behind the head", () => {
  const bytes = cdr([1, 7], [8, 1.5], "ab", [4, 9], [1, 1]);
  expect(read("uint8 a\nfloat64 b\nstring c\nuint32 d\nbool e", bytes)).toEqual({
    a: 7,
    b: 1.5,
    c: "ab",
    d: 9,
    e: true,
  });
});

it("arrays are aligned behind their lengths, unless they are empty", () => {
  const bytes = cdr([1, 1], [4, 2], [8, 0.5], [8, 2], [4, 0], [4, 5]);
  expect(read("uint8 a\nfloat64[] b\nfloat64[] c\nuint32 d", bytes)).toEqual({
    a: 1,
    b: new Float64Array([0.5, 2]),
    c: new Float64Array(),
    d: 5,
  });
});

it("times are two numbers of four bytes", () => {
  const definition = "uint32 a\nbuiltin_interfaces/Time stamp\nstring[2] names";
  expect(read(definition, cdr([4, 1], [4, 12], [4, 34], "x", "yz"))).toEqual({
    a: 1,
    stamp: { secs: 12, nsecs: 34 },
    names: ["x", "yz"],
  });
});

it("messages that end early, or of another CDR, are refused", () => {
  expect(() => read("uint32 a", cdr([1, 1]))).toThrow("ends early");
  expect(() => read("uint32 a", new Uint8Array([0, 0, 0, 0, 0, 0, 0, 1]))).toThrow("little-endian");
});
