import { expect, test } from "vitest";
import { fieldFrom } from "./field_drag";

test("only fields of topics can be dropped", () => {
  expect(fieldFrom('["/a", "x.y"]')).toEqual(["/a", "x.y"]);
  for (const text of ["", "{", "null", '"/a"', '["/a"]', '["/a", 1]', '["/a", "x", "y"]'])
    expect(fieldFrom(text)).toBe(undefined);
});
