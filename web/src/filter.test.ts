import { expect, test } from "vitest";

import { Filter } from "./filter";

const matches = (text: string, ...fields: string[]): boolean => new Filter(text).matches(...fields);

test("an empty filter matches everything", () => {
  expect(matches("", "x")).toBe(true);
  expect(matches("  ")).toBe(true);
  expect(new Filter(" ").isEmpty).toBe(true);
});

test("all words must occur, in any field and any case", () => {
  expect(matches("SCAN  a/b", "/scan", "a/B")).toBe(true);
  expect(matches("scan laser", "/scan", "a/B")).toBe(false);
  expect(matches("a.b", "/axb")).toBe(false);
});

test("a word does not match across two fields", () => {
  expect(matches("ab", "/a", "b")).toBe(false);
});

test.each([
  ["/robot", "/robot/scan", true],
  ["/robot", "/ROBOT2", true],
  ["/robot", "/my/robot", false],
  ["/robot/s", "/robot/scan", true],
  ["/string", "std_msgs/String", false],
  ["/robot scan", "/robot/scan", true],
  ["/scan", "subscribed to /scan.", true],
  ["/a.b", "/axb", false],
])("a word with a slash matches the start of a name: %s in %s is %s", (text, field, expected) => {
  expect(matches(text, field)).toBe(expected);
});

test.each([
  ["-camera", "/scan", true],
  ["-camera", "/Camera/image", false],
  ["robot -camera", "/robot/camera", false],
  ["robot -/camera", "/robot/camera", true],
  ["-", "/anything", true],
  ["image -", "/anything", false],
])("a word with a minus excludes: %s in %s is %s", (text, field, expected) => {
  expect(matches(text, field)).toBe(expected);
});

test("exclusion can be asked for alone", () => {
  const filter = new Filter("robot -camera");
  expect(filter.excludes("/camera")).toBe(true);
  expect(filter.excludes("/scan")).toBe(false);
});

test.each([
  ["/robot,-/tf", "/robot/scan", true],
  ["-/tf, -/rosout", "/rosout", false],
])("commas separate words, as in rqt_graph: %s", (text, field, expected) => {
  expect(matches(text, field)).toBe(expected);
});

test("something is shown if a neighbour matches, but not if it is excluded itself", () => {
  const shows = (text: string): boolean =>
    new Filter(text).shows(["/scan", "sensor_msgs/LaserScan"], [["/driver"], ["/viewer"]]);
  expect(shows("/driver")).toBe(true);
  expect(shows("laser")).toBe(true);
  expect(shows("/other")).toBe(false);
  expect(shows("/driver -/scan")).toBe(false);
  // Excluding one neighbour hides only that one.
  expect(shows("-/driver")).toBe(true);
  expect(shows("driver viewer")).toBe(false);
});
