import { expect, it } from "vitest";
import { matches } from "./filter";

it("finds what has all the words in some field, whatever the case", () => {
  expect(matches("", "x")).toBe(true);
  expect(matches("SCAN  a/b", "/scan", "a/B")).toBe(true);
  expect(matches("scan laser", "/scan", "a/B")).toBe(false);
});
