import { expect, test } from "vitest";

import { enclosing, namespaces } from "./namespaces";

const named = (...names: string[]) => names.map((name) => ({ id: name, name }));

test("all namespaces of a name are found", () => {
  expect(enclosing("/robot/arm/camera")).toEqual(["/robot", "/robot/arm"]);
  expect(enclosing("/camera")).toEqual([]);
});

test("namespaces with two elements are drawn, nested", () => {
  const { groups, of } = namespaces(named("/r/a", "/r/arm/b", "/r/arm/c", "/d"), null);
  expect(groups).toEqual([
    { name: "/r", parent: null },
    { name: "/r/arm", parent: "/r" },
  ]);
  expect(of.get("/r/arm/b")).toBe("/r/arm");
  expect(of.get("/r/a")).toBe("/r");
  expect(of.has("/d")).toBe(false);
});

test("only the innermost of equal namespaces is drawn", () => {
  expect(namespaces(named("/a/b/c/x", "/a/b/c/y", "/z"), null).groups).toEqual([
    { name: "/a/b/c", parent: null },
  ]);
});

test("none is drawn for one element, for a single namespace, or if not wanted", () => {
  expect(namespaces(named("/r/a", "/b"), null).groups).toEqual([]);
  expect(namespaces(named("/r/a", "/r/b"), null).groups).toEqual([]);
  expect(namespaces(named("/r/a", "/r/b"), true).groups).toHaveLength(1);
  expect(namespaces(named("/r/a", "/r/b", "/c"), false).groups).toEqual([]);
});
