import { expect, test } from "vitest";

import { type Entry, levelName, line, passes } from "./entry";

const entry: Entry = {
  number: 1,
  secs: 12,
  nsecs: 345_678_901,
  level: 4,
  node: "/robot/arm",
  text: "It is Hot",
  where: "",
};
const ALL = { level: 0, node: "", text: "" };

test("a line is as rospy writes it", () => {
  expect(line(entry)).toBe("[WARN] [12.345678] [/robot/arm]: It is Hot");
});

test("a level that ROS does not know keeps its number", () => {
  expect(levelName(8)).toBe("ERROR");
  expect(levelName(3)).toBe("LEVEL 3");
});

test.each([
  [{}, true],
  [{ level: 4 }, true],
  [{ level: 8 }, false],
  [{ node: "/robot/arm" }, true],
  [{ node: "/robot" }, false],
  [{ text: "hot" }, true],
  [{ text: "ARM" }, true],
  [{ text: "cold" }, false],
  [{ level: 4, text: "cold" }, false],
])("a filter of %j lets a warning of the arm pass: %s", (filter, through) => {
  expect(passes(entry, { ...ALL, ...filter })).toBe(through);
});
