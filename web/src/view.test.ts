import { expect, test } from "vitest";

import { pathOf, route } from "./view";

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
