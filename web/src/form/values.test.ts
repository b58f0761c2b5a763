import { describe, expect, it } from "vitest";
import { typedef } from "../typedef.fixture";
import { Types } from "../types";
import { type Problem, parseJson } from "./parsing";
import { checkMessage, initial, initialMessage, sendable } from "./values";

const HEADER = typedef("std_msgs/Header", [
  ["seq", "uint32"],
  ["stamp", "time"],
  ["frame_id", "string"],
]);
const THING = new Types([
  typedef("a/Thing", [
    ["header", "std_msgs/Header"],
    ["n", "int8"],
    ["big", "int64"],
    ["x", "float32"],
    ["on", "bool"],
    ["at", "time"],
    ["wait", "duration"],
    ["three", "int16", 3],
    ["any", "string", 0],
    ["data", "uint8", 0],
    ["uuid", "uint8", 4],
    ["points", "a/Point", 0],
    ["f", "float64"],
  ]),
  HEADER,
  typedef("a/Point", [
    ["x", "float64"],
    ["__proto__", "int8"],
  ]),
]);

function check(value: unknown): { value: unknown; problems: string[] } {
  const problems: Problem[] = [];
  const checked = checkMessage(THING, "a/Thing", value, problems);
  return { value: checked, problems: problems.map(({ path, text }) => `${path}: ${text}`) };
}

describe("the initial value of a field", () => {
  it("depends on its type", () => {
    expect(initialMessage(THING, "a/Thing")).toEqual({
      header: { seq: 0, stamp: "now", frame_id: "" },
      n: 0,
      big: 0,
      x: 0,
      on: false,
      at: { secs: 0, nsecs: 0 },
      wait: { secs: 0, nsecs: 0 },
      three: [0, 0, 0],
      any: [],
      data: "",
      uuid: btoa("\0\0\0\0"),
      points: [],
      f: 0,
    });
    expect(Object.keys(initialMessage(THING, "a/Point"))).toEqual(["x", "__proto__"]);
    expect(initial(THING, { name: "p", type: "a/Point", array: 1 })).toHaveLength(1);
  });

  it("is valid", () => {
    const first = initialMessage(THING, "a/Thing");
    expect(check(first)).toEqual({ value: first, problems: [] });
  });
});

describe("a message as JSON", () => {
  it("is checked against its type", () => {
    const value = {
      n: 1,
      x: null,
      three: [1, 2, 3],
      any: ["a"],
      data: [1, 2, 3],
      points: [{ x: 1 }],
      at: "now",
      wait: { secs: 1 },
      big: "12",
      f: 0.5,
    };
    expect(check(value)).toEqual({
      value: { ...value, data: "AQID", wait: { secs: 1, nsecs: 0 }, big: 12 },
      problems: [],
    });
  });

  it("has all its problems listed with their paths", () => {
    expect(
      check({
        n: 300,
        nope: 1,
        three: [1],
        any: "a",
        points: [{ y: 1 }, 3],
        on: 1,
        at: 3,
        wait: "now",
        x: true,
        data: "A",
        header: { stamp: { secs: 1.5 } },
        big: [],
      }).problems,
    ).toEqual([
      expect.stringMatching(/^n: 300 .*-128 to 127/),
      expect.stringMatching(/^nope: .* a\/Thing.* header, n, big, .*, points, f$/),
      expect.stringMatching(/^three: .* 3 elements .* got 1$/),
      expect.stringMatching(/^any: .* list .* string\[\]$/),
      expect.stringMatching(/^points\[0\]\.y: .* a\/Point.* x, __proto__$/),
      expect.stringMatching(/^points\[1\]: .* object .* a\/Point$/),
      expect.stringMatching(/^on: .* bool, got 1$/),
      expect.stringMatching(/^at: .* "now"/),
      expect.stringMatching(/^wait: .* "nsecs"/),
      expect.stringMatching(/^x: .* float32, got true$/),
      expect.stringMatching(/^data: .* base64/),
      expect.stringMatching(/^header\.stamp: .* "nsecs"/),
      expect.stringMatching(/^big: .* int64, got \[\]$/),
    ]);
    expect(check([]).problems).toEqual([expect.stringMatching(/^: .* object .* a\/Thing$/)]);
  });

  it("may have fields of any name", () => {
    const checked = check({ points: [parseJson('{"__proto__": 3}')] });
    expect(checked.problems).toEqual([]);
    expect(JSON.stringify(sendable(THING, "a/Thing", checked.value))).toBe(
      '{"points":[{"__proto__":3}]}',
    );
  });

  it("is sent with all digits of large integers if the browser supports it", () => {
    const json = JSON as typeof JSON & { rawJSON?: (text: string) => unknown };
    const former = json.rawJSON;
    json.rawJSON = (text) => ({ raw: text });
    const message = { big: "9007199254740993", data: btoa("\xd3M4\xd3M4\xd3M4\xd3M4"), n: 1 };
    expect(sendable(THING, "a/Thing", message)).toEqual({
      ...message,
      big: { raw: "9007199254740993" },
    });
    delete json.rawJSON;
    expect(sendable(THING, "a/Thing", message)).toEqual(message);
    if (former !== undefined) json.rawJSON = former;
  });
});
