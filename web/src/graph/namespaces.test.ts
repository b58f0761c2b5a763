import { expect, it } from "vitest";

import { enclosing, namespaces } from "./namespaces";

const named = (...names: string[]) => names.map((name) => ({ id: name, name }));

it("knows all namespaces around a name", () => {
  expect(enclosing("/robot/arm/camera")).toEqual(["/robot", "/robot/arm"]);
  expect(enclosing("/camera")).toEqual([]);
});

it("draws a namespace that has two elements, inside the one around it", () => {
  const { groups, of } = namespaces(named("/r/a", "/r/arm/b", "/r/arm/c", "/d"), null);
  expect(groups).toEqual([
    { name: "/r", parent: null },
    { name: "/r/arm", parent: "/r" },
  ]);
  expect(of.get("/r/arm/b")).toBe("/r/arm");
  expect(of.get("/r/a")).toBe("/r");
  expect(of.has("/d")).toBe(false);
});

it("draws one box where several would be around the same", () => {
  expect(namespaces(named("/a/b/c/x", "/a/b/c/y", "/z"), null).groups).toEqual([
    { name: "/a/b/c", parent: null },
  ]);
});

it("draws none around a single element, nor where all have the same, nor when not wanted", () => {
  expect(namespaces(named("/r/a", "/b"), null).groups).toEqual([]);
  expect(namespaces(named("/r/a", "/r/b"), null).groups).toEqual([]);
  expect(namespaces(named("/r/a", "/r/b"), true).groups).toHaveLength(1);
  expect(namespaces(named("/r/a", "/r/b", "/c"), false).groups).toEqual([]);
});
