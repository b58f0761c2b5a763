import { expect, test } from "vitest";

import {
  type Config,
  type ConfigDescription,
  configOf,
  groupsOf,
  parseValue,
  statesOf,
  valuesOf,
} from "./configuration";
import { literalOf } from "./python_literal";

const EMPTY: Config = { bools: [], ints: [], strs: [], doubles: [], groups: [] };
const SIZES =
  "{'enum_description': 'A \"size\"', 'enum': [{'name': 'Small', 'type': 'int', 'value': 0, " +
  "'srcline': 1, 'description': 'It\\'s small', 'cconsttype': None}, {'name': u'Big', 'value': 3},]}";

function parameter(name: string, type: string, edit_method = "") {
  return { name, type, level: 0, description: `The ${name}`, edit_method };
}

function described(
  ...groups: Partial<ConfigDescription["groups"][number]>[]
): ConfigDescription["groups"] {
  return groups.map((group) => ({
    name: "Default",
    type: "",
    id: 0,
    parent: 0,
    parameters: [],
    ...group,
  }));
}

test("parameters have their ranges, defaults and choices", () => {
  const root = groupsOf({
    groups: described({
      parameters: [parameter("speed", "double"), parameter("size", "int", SIZES)],
    }),
    max: { ...EMPTY, doubles: [{ name: "speed", value: 2 }], ints: [{ name: "size", value: 3 }] },
    min: {
      ...EMPTY,
      doubles: [{ name: "speed", value: null }],
      ints: [{ name: "size", value: -(2 ** 31) }],
    },
    dflt: { ...EMPTY, doubles: [{ name: "speed", value: 0.5 }] },
  });
  expect(root?.parameters).toMatchObject([
    { name: "speed", kind: "double", min: undefined, max: 2, default: 0.5, choices: [] },
    {
      name: "size",
      min: undefined,
      max: 3,
      default: undefined,
      choices: [
        { name: "Small", value: 0, description: "It's small" },
        { name: "Big", value: 3, description: "" },
      ],
    },
  ]);
});

test("groups are nested, and none is lost in a circle", () => {
  const groups = described(
    {},
    { id: 1, name: "one" },
    { id: 2, parent: 1, name: "two" },
    { id: 3, parent: 4, name: "three" },
    { id: 4, parent: 3, name: "four" },
  );
  const root = groupsOf({ groups, max: EMPTY, min: EMPTY, dflt: EMPTY });
  expect(root?.groups.map(({ name }) => name)).toEqual(["one", "three", "four"]);
  expect(root?.groups[0]?.groups.map(({ name }) => name)).toEqual(["two"]);
});

test("a description without groups has nothing to show", () => {
  expect(groupsOf({ groups: [], max: EMPTY, min: EMPTY, dflt: EMPTY })).toBeNull();
});

test("a changed value is sent by its type, and read again", () => {
  const root = groupsOf({
    groups: described({
      parameters: [parameter("on", "bool"), parameter("count", "int"), parameter("name", "str")],
    }),
    max: EMPTY,
    min: EMPTY,
    dflt: EMPTY,
  });
  const [on, count, name] = root?.parameters ?? [];
  if (!root || !on || !count || !name) throw new Error("missing parameters");
  const config = configOf(
    [
      [on, true],
      [count, 3],
      [name, "x"],
    ],
    [{ name: root.name, state: false, id: 0, parent: 0 }],
  );
  expect(config.bools).toEqual([{ name: "on", value: true }]);
  expect([...valuesOf(config)]).toEqual([
    ["on", true],
    ["count", 3],
    ["name", "x"],
  ]);
  expect(statesOf(config)).toEqual(new Map([[0, false]]));
  expect(parseValue(count, " -7 ")).toBe(-7);
  expect(() => parseValue(count, "1.5")).toThrow("integer");
  expect(() => parseValue({ ...count, kind: "double" }, "fast")).toThrow("number");
  expect(parseValue(name, "1.5")).toBe("1.5");
});

test.each([
  ["{'a': [1, -2.5, (True, None)], \"b\": 'x\\n\\x41'}", [1, -2.5, [true, null]]],
  ["{'a': 1L}", 1],
])("Python literal %s", (text, a) => {
  expect((literalOf(text) as Map<unknown, unknown>).get("a")).toEqual(a);
});

test.each(["", "{'a'", "{'a': }", "[1 2]", "f(x)", "[".repeat(30), "'unfinished", "1 2"])(
  "invalid Python literal %s",
  (text) => {
    expect(() => literalOf(text)).toThrow();
  },
);
