import { expect, test } from "vitest";

import { Filter } from "../filter";
import { type Entry, levelName, line, passes } from "./log";

const entry: Entry = {
  number: 1,
  secs: 12,
  nsecs: 345_678_901,
  level: 4,
  node: "/robot/arm",
  text: "It is Hot",
  where: "",
};
const ALL = { level: 0, node: "", text: new Filter() };

test("a line has the format of rospy", () => {
  expect(line(entry)).toBe("[WARN] [12.345678] [/robot/arm]: It is Hot");
});

test("an unknown level is shown by its number", () => {
  expect(levelName(8)).toBe("ERROR");
  expect(levelName(3)).toBe("LEVEL 3");
});

test.each([
  [{}, true],
  [{ level: 4 }, true],
  [{ level: 8 }, false],
  [{ node: "/robot/arm" }, true],
  [{ node: "/robot" }, false],
  [{ text: new Filter("hot") }, true],
  [{ text: new Filter("ARM") }, true],
  [{ text: new Filter("cold") }, false],
  [{ text: new Filter("hot -arm") }, false],
  [{ level: 4, text: new Filter("cold") }, false],
])("the filter %j on a warning of the arm gives %s", (filter, expected) => {
  expect(passes(entry, { ...ALL, ...filter })).toBe(expected);
});
