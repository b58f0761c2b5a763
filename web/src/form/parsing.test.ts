import { describe, expect, it } from "vitest";
import { parseBytes, parseJson, parseText, textOf } from "./parsing";

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
    expect(parseText(type, text)).toEqual({ value });
  });

  const bad: [type: string, text: string, ...facts: string[]][] = [
    ["int8", "300", "300", "out of range", "int8", "-128 to 127"],
    ["uint8", "-1", "-1", "out of range", "uint8", "0 to 255"],
    ["int32", "1.5", "“1.5”", "not an integer", "int32"],
    ["int8", "", "missing", "int8"],
    ["int64", "9223372036854775808", "out of range", "-9223372036854775808 to 9223372036854775807"],
    ["float64", "ten", "“ten”", "not a number"],
    ["float64", "", "missing"],
    ["float32", "1e39", "1e39", "too large", "float32"],
    ["float64", "1e400", "1e400", "too large", "float64"],
    ["bool", "yes", "“yes”", "true or false"],
    ["time", "-1", "-1", "out of range", "0 to 4294967295"],
    ["time", "soon", "“soon”", "not a time", "now"],
    ["duration", "now", "“now”", "not a duration", "seconds"],
    ["a/Point", "x", "a/Point"],
    ["int8", "x".repeat(50), `“${"x".repeat(40)}…”`],
  ];
  it.each(bad)("of %s cannot be %j", (type, text, ...facts) => {
    const { problem } = parseText(type, text) as { problem: string };
    for (const fact of facts) expect(problem).toContain(fact);
  });

  it("survives a round trip", () => {
    for (const [type, , value] of good.filter(([, text]) => text !== " -128 ")) {
      expect(parseText(type, textOf(value))).toEqual({ value });
    }
    expect(textOf([1])).toBe("[1]");
  });
});

describe("bytes", () => {
  const data = { name: "data", type: "uint8", array: 0 };
  it("are base64 or a list", () => {
    expect(parseBytes(data, " AQID ")).toEqual({ value: "AQID" });
    expect(parseBytes(data, "[1, 2, 3]")).toEqual({ value: "AQID" });
    expect(parseBytes(data, "")).toEqual({ value: "" });
    expect(parseBytes({ ...data, array: 3 }, "AQID")).toEqual({ value: "AQID" });
  });
  it("are rejected if invalid", () => {
    const problem = (text: string, array = 0): string =>
      (parseBytes({ ...data, array }, text) as { problem: string }).problem;
    expect(problem("AQI")).toContain("base64");
    expect(problem("[1, 256]")).toMatch(/256 .*0-255/);
    expect(problem("[1,")).toContain("invalid list");
    expect(problem("AQID", 4)).toMatch(/4 elements for uint8\[4\], got 3/);
  });
});

describe("JSON text", () => {
  it("keeps large integers exact, except within strings", () => {
    expect(
      parseJson(
        '{"a": 9007199254740993, "b": "say 9007199254740993, \\" 9007199254740993", "c": 1.5e3}',
      ),
    ).toEqual({ a: "9007199254740993", b: 'say 9007199254740993, " 9007199254740993', c: 1500 });
    expect(() => parseJson("{")).toThrow(SyntaxError);
  });
});
