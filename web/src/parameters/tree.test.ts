import { expect, test } from "vitest";

import { tree } from "./tree";

test("parameters stand in the namespaces that their names lead through", () => {
  const root = tree([
    ["/a", "1"],
    ["/robot/arm/joints", "6"],
    ["/robot/speed", "0.5"],
  ]);
  expect(root.count).toBe(3);
  expect(root.leaves).toEqual([{ name: "/a", key: "a", value: "1" }]);
  const robot = root.spaces.get("robot");
  expect(robot?.name).toBe("/robot");
  expect(robot?.count).toBe(2);
  expect(robot?.leaves.map(({ key }) => key)).toEqual(["speed"]);
  expect(robot?.spaces.get("arm")?.leaves).toEqual([
    { name: "/robot/arm/joints", key: "joints", value: "6" },
  ]);
});

test("a key may be any text", () => {
  const root = tree([["/__proto__/constructor", "1"]]);
  expect(root.spaces.get("__proto__")?.leaves[0]?.key).toBe("constructor");
});
