import { describe, expect, it } from "vitest";
import { parseJson, readBytes, readText, textOf } from "./readings";

describe("the text of an input", () => {
  const good: [type: string, text: string, value: unknown][] = [
    ["int8", " -128 ", -128],
    ["uint8", "0xff", 255],
    ["int64", "9007199254740993", "9007199254740993"],
    ["int64", "9007199254740991", 9007199254740991],
    ["uint64", "18446744073709551615", "18446744073709551615"],
    ["float64", "1e3", 1000],
    ["float32", ".5", 0.5],
    ["float32", "NaN", null],
    ["string", " a ", " a "],
    ["bool", "true", true],
    ["time", "now", "now"],
    ["time", "12.000000001", { secs: 12, nsecs: 1 }],
    ["time", "1970-01-01T00:00:01.5Z", { secs: 1, nsecs: 500_000_000 }],
    ["duration", "-1.5", { secs: -2, nsecs: 500_000_000 }],
  ];
  it.each(good)("of %s %j is %j", (type, text, value) => {
    expect(readText(type, text)).toEqual({ value });
  });

  const bad: [type: string, text: string, problem: string][] = [
    ["int8", "300", "300 does not fit: int8 holds -128 to 127"],
    ["uint8", "-1", "-1 does not fit: uint8 holds 0 to 255"],
    ["int32", "1.5", "“1.5” is no whole number: int32 holds -2147483648 to 2147483647"],
    ["int8", "", "a whole number is missing: int8 holds -128 to 127"],
    [
      "int64",
      "9223372036854775808",
      "9223372036854775808 does not fit: int64 holds -9223372036854775808 to 9223372036854775807",
    ],
    ["float64", "ten", "“ten” is no number (1.5, -2e-3 and nan are)"],
    ["float64", "", "a number is missing"],
    ["float32", "1e39", "1e39 is too large for a float32"],
    ["float64", "1e400", "1e400 is too large for a float64"],
    ["bool", "yes", "a bool is true or false, not “yes”"],
    ["time", "-1", "-1 does not fit: a time holds 0 to 4294967295 seconds"],
    ["time", "soon", "“soon” is no time: write seconds since 1970, a date, or now"],
    ["duration", "now", "“now” is no duration: write seconds"],
    ["a/Point", "x", "a/Point is no single value"],
    ["int8", "x".repeat(50), `“${"x".repeat(40)}…” is no whole number: int8 holds -128 to 127`],
  ];
  it.each(bad)("of %s cannot be %j", (type, text, problem) => {
    expect(readText(type, text)).toEqual({ problem });
  });

  it("is written as it is read", () => {
    for (const [type, , value] of good.filter(([, text]) => text !== " -128 ")) {
      expect(readText(type, textOf(value))).toEqual({ value });
    }
    expect(textOf([1])).toBe("[1]");
  });
});

describe("bytes", () => {
  const data = { name: "data", type: "uint8", array: 0 };
  it("are base64 or a list", () => {
    expect(readBytes(data, " AQID ")).toEqual({ value: "AQID" });
    expect(readBytes(data, "[1, 2, 3]")).toEqual({ value: "AQID" });
    expect(readBytes(data, "")).toEqual({ value: "" });
    expect(readBytes({ ...data, array: 3 }, "AQID")).toEqual({ value: "AQID" });
  });
  it("are refused with words", () => {
    expect(readBytes(data, "AQI")).toEqual({
      problem: "bytes are base64 (AQID), or a list of numbers ([1, 2, 3])",
    });
    expect(readBytes(data, "[1, 256]")).toEqual({ problem: "256 is no byte: those are 0 to 255" });
    expect(readBytes(data, "[1,")).toEqual({ problem: "this list is no JSON: [1, 2, 255] is" });
    expect(readBytes({ ...data, array: 4 }, "AQID")).toEqual({
      problem: "uint8[4] has 4 elements, not 3",
    });
  });
});

describe("JSON text", () => {
  it("keeps long integers exact, but not those within strings", () => {
    expect(
      parseJson(
        '{"a": 9007199254740993, "b": "say 9007199254740993, \\" 9007199254740993", "c": 1.5e3}',
      ),
    ).toEqual({ a: "9007199254740993", b: 'say 9007199254740993, " 9007199254740993', c: 1500 });
    expect(() => parseJson("{")).toThrow(SyntaxError);
  });
});
