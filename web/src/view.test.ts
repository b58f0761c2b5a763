import { expect, test } from "vitest";

import { pathOf, route } from "./view";

test.each([[["graph"]], [["topics", "/robot/scan"]], [["graph", "node", "/a b%"]]])(
  "the path %j is found again in its address",
  (path) => expect(pathOf(route(...path))).toEqual(path),
);

test("an address that cannot be decoded stands as it is", () => {
  expect(pathOf("#/topics/%zz")).toEqual(["topics", "%zz"]);
});

test("no address is no path", () => {
  expect(pathOf("")).toEqual([]);
});
