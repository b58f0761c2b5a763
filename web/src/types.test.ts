import { describe, expect, it } from "vitest";
import { numberAt } from "./messages/values";
import { typedef } from "./typedef.fixture";
import {
  byteLength,
  bytesOf,
  isBytes,
  kindOf,
  own,
  parsePath,
  pathText,
  rangeOf,
  Types,
  typeText,
} from "./types";

const HEADER = typedef("std_msgs/Header", [
  ["seq", "uint32"],
  ["stamp", "time"],
  ["frame_id", "string"],
]);
const TIME = typedef("time", [
  ["secs", "int32"],
  ["nsecs", "int32"],
]);
const SCAN = new Types([
  typedef("a/Scan", [
    ["header", "std_msgs/Header"],
    ["ranges", "float32", 0],
    ["points", "a/Point", 2],
    ["name", "string"],
    ["on", "bool"],
  ]),
  HEADER,
  TIME,
  typedef("a/Point", [
    ["x", "float64"],
    ["y", "float64"],
  ]),
]);

describe("types", () => {
  it("have kinds, and integers have ranges", () => {
    expect(
      ["int8", "char", "float32", "wstring", "bool", "time", "duration", "a/B"].map(kindOf),
    ).toEqual(["integer", "integer", "float", "string", "bool", "time", "duration", "message"]);
    expect(rangeOf("int8")).toEqual([-128n, 127n]);
    expect(rangeOf("uint64")).toEqual([0n, 18446744073709551615n]);
    expect(rangeOf("float32")).toBeUndefined();
    expect(isBytes({ name: "data", type: "uint8", array: 0 })).toBe(true);
    expect(isBytes({ name: "data", type: "uint8", array: -1 })).toBe(false);
    expect(typeText({ name: "c", type: "float64", array: 36 })).toBe("float64[36]");
  });

  it("list the paths of their numbers", () => {
    expect(SCAN.numberPaths()).toEqual([
      "header.seq",
      "header.stamp",
      "ranges[0]",
      "points[0].x",
      "points[0].y",
      "points[1].x",
      "points[1].y",
      "on",
    ]);
    expect(SCAN.numberPaths(3)).toHaveLength(3);
    expect(SCAN.plotPaths()).toEqual(["ranges[0]"]);
    expect(new Types([typedef("std_msgs/Int32", [["data", "int32"]])]).plotPaths()).toEqual([
      "data",
    ]);
    expect(new Types([]).numberPaths()).toEqual([]);
  });

  it("read the number at a path", () => {
    const at = (message: unknown, path: string): number | bigint | undefined =>
      numberAt(message, (parsePath(path) ?? []) as (string | number)[]);
    expect(parsePath("poses[3].x")).toEqual(["poses", 3, "x"]);
    expect(parsePath("position[arm/elbow.left 2].x")).toEqual([
      "position",
      { name: "arm/elbow.left 2" },
      "x",
    ]);
    for (const invalid of ["", "poses[]", "poses[x", "poses.", "a..b", "[3]", "a[1]b"])
      expect(parsePath(invalid)).toBeUndefined();
    for (const path of ["poses[3].x", "a[1][2]", "position[arm/elbow.left 2].x"])
      expect(pathText(parsePath(path) ?? [])).toBe(path);
    expect(at({ pose: { x: 1.5 } }, "pose.x")).toBe(1.5);
    expect(at({ ranges: [1, 2] }, "ranges[1]")).toBe(2);
    expect(at({ ranges: [1, 2] }, "ranges[2]")).toBeUndefined();
    expect(at({ data: btoa("\x01\x02\x03\xff") }, "data[3]")).toBe(255);
    expect(at({ data: "abc" }, "data")).toBeUndefined();
    expect(at({ on: true }, "on")).toBe(1);
    expect(at({ stamp: { secs: 2, nsecs: 500_000_000 } }, "stamp")).toBe(2.5);
    expect(at({ x: null }, "x.y")).toBeUndefined();
  });

  it("use only own properties, whatever their names are", () => {
    expect(own({}, "constructor")).toBeUndefined();
    expect(own(JSON.parse('{"__proto__": 3}'), "__proto__")).toBe(3);
    expect(numberAt({}, ["__proto__", "length"])).toBeUndefined();
    const odd = new Types([
      typedef("a/Odd", [
        ["__proto__", "int8"],
        ["toString", "int8"],
      ]),
    ]);
    expect(odd.numberPaths()).toEqual(["__proto__", "toString"]);
    expect(odd.fields("constructor")).toEqual([]);
  });

  it("offer the constants that fit a field", () => {
    const status = new Types([
      typedef(
        "a/Status",
        [["status", "uint8"]],
        [
          ["ACTIVE", "1"],
          ["BIG", "300"],
          ["NAME", "x"],
          ["PI", "3.14"],
        ],
      ),
    ]);
    expect(status.statePaths()).toEqual(["status"]);
    expect(SCAN.statePaths()[0]).toBe("on");
    expect(SCAN.statePaths()).not.toContain("header.seq");
    expect(status.constants("a/Status", "uint8")).toEqual([{ name: "ACTIVE", value: "1" }]);
    expect(status.constants("a/Status", "string")).toEqual([{ name: "NAME", value: "x" }]);
    expect(status.constants("a/Status", "float64")).toEqual([]);
  });

  it("decode base64", () => {
    expect(byteLength(btoa("abcd"))).toBe(4);
    expect(byteLength("")).toBe(0);
    expect([...(bytesOf(btoa("ab")) ?? [])]).toEqual([97, 98]);
    expect(bytesOf("*")).toBeUndefined();
  });
});
