import { expect, test } from "vitest";

import { pathOf, route, stateOf, withState } from "./view";

test.each([[["graph"]], [["topics", "/robot/scan"]], [["graph", "node", "/a b%"]]])(
  "the path %j survives a round trip",
  (path) => expect(pathOf(route(...path))).toEqual(path),
);

test("an invalid escape stays as it is", () => {
  expect(pathOf("#/topics/%zz")).toEqual(["topics", "%zz"]);
});

test("an empty fragment is an empty path", () => {
  expect(pathOf("")).toEqual([]);
});

test("the state follows the path", () => {
  const hash = withState("#/topics/%2Fscan?filter=old", { filter: "/a & -b?", debug: true });
  expect(hash).toBe("#/topics/%2Fscan?filter=/a+%26+-b%3F&debug=1");
  expect(pathOf(hash)).toEqual(["topics", "/scan"]);
  expect(stateOf(hash)?.get("filter")).toBe("/a & -b?");
});

test("entries that are empty or false are left out", () => {
  expect(withState("#/topics?debug=1", { filter: "", debug: false })).toBe("#/topics");
  expect(withState("", { debug: true })).toBe("#/?debug=1");
});

test("a URL without a state has none, not an empty one", () => {
  expect(stateOf("#/topics")).toBeNull();
  expect(stateOf("#/topics?")).toEqual(new URLSearchParams());
});
