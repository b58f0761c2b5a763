import { expect, test } from "vitest";

import { kind, meant, written } from "./value";

test.each([
  ["12", "integer"],
  ["12.0", "number"],
  ["1e3", "number"],
  ["true", "true or false"],
  ['"12"', "text"],
  ["[1]", "list"],
  ["{}", "object"],
])("%s is of kind %s", (json, expected) => expect(kind(json)).toBe(expected));

test.each([
  ["hello", '"hello"'],
  [" 12 ", "12"],
  ["1.0", "1.0"],
  ["", '""'],
  ["[1, 2", '"[1, 2"'],
  ['"12"', '"12"'],
  ["NaN", '"NaN"'],
  ["9223372036854775809", "9223372036854775809"],
])("who writes %j means %s", (text, json) => expect(meant(text)).toBe(json));

test.each(['"hello"', '"12"', '""', '"noetic\\n"', '" a"', "1.0", "[1.0, 2]", '"true"', '"{"'])(
  "%s is the same after it was written and read again",
  (json) => expect(meant(written(json))).toBe(json),
);

test("a plain text is written without quotes", () => {
  expect(written('"hello"')).toBe("hello");
});
