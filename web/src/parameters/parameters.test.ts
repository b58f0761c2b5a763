import { expect, test } from "vitest";

import { fromText, kind, parameterTree, splitParameters, toText } from "./parameters";

test("parameters are arranged by namespaces", () => {
  const root = parameterTree([
    ["/a", "1"],
    ["/robot/arm/joints", "6"],
    ["/robot/speed", "0.5"],
  ]);
  expect(root.count).toBe(3);
  expect(root.parameters).toEqual([{ name: "/a", key: "a", value: "1" }]);
  const robot = root.children.get("robot");
  expect(robot?.name).toBe("/robot");
  expect(robot?.count).toBe(2);
  expect(robot?.parameters.map(({ key }) => key)).toEqual(["speed"]);
  expect(robot?.children.get("arm")?.parameters).toEqual([
    { name: "/robot/arm/joints", key: "joints", value: "6" },
  ]);
});

test("a key may be any text", () => {
  const root = parameterTree([["/__proto__/constructor", "1"]]);
  expect(root.children.get("__proto__")?.parameters[0]?.key).toBe("constructor");
});

test.each([
  ["12", "integer"],
  ["12.0", "number"],
  ["1e3", "number"],
  ["true", "true or false"],
  ['"12"', "text"],
  ["[1]", "list"],
  ["{}", "object"],
])("%s is of kind %s", (json, expected) => expect(kind(json)).toBe(expected));

test.each([
  ["hello", '"hello"'],
  [" 12 ", "12"],
  ["1.0", "1.0"],
  ["", '""'],
  ["[1, 2", '"[1, 2"'],
  ['"12"', '"12"'],
  ["NaN", '"NaN"'],
  ["9223372036854775809", "9223372036854775809"],
])("the text %j means %s", (text, json) => expect(fromText(text)).toBe(json));

test.each(['"hello"', '"12"', '""', '"noetic\\n"', '" a"', "1.0", "[1.0, 2]", '"true"', '"{"'])(
  "%s survives a round trip",
  (json) => expect(fromText(toText(json))).toBe(json),
);

test("a plain string has no quotes", () => {
  expect(toText('"hello"')).toBe("hello");
});

test("a namespace is split into parameters with their exact texts", () => {
  const json =
    '{"robot": {"speed": 1.0, "name": "a \\"b\\", [c}", "arm": {"joints": [1, {"x": [2]}, "]"]}},' +
    '"large":9223372036854775809,"a":true, "empty": {}, "__proto__": {"x": -1e-7}}';
  expect(splitParameters(json)).toEqual([
    ["/__proto__/x", "-1e-7"],
    ["/a", "true"],
    ["/large", "9223372036854775809"],
    ["/robot/arm/joints", '[1, {"x": [2]}, "]"]'],
    ["/robot/name", '"a \\"b\\", [c}"'],
    ["/robot/speed", "1.0"],
  ]);
  expect(splitParameters("{}")).toEqual([]);
});

test.each(["", "{", '{"a": [1', '{"a'])("the invalid JSON %j is an error", (json) => {
  expect(() => splitParameters(json)).toThrow(SyntaxError);
});
