import { expect, it } from "vitest";
import { hasText } from "./values";

it.each([
  ["battery", true],
  ["-0.5", true],
  ["0.5", false],
  ["9007199254740993", true],
  ["true", true],
  ["7", true],
  ["elbow", true],
  ["wrist", false],
])("a message has the text %s: %s", (text, expected) => {
  const message = {
    text: "Low Battery",
    value: -0.5,
    count: 9007199254740993n,
    ok: true,
    data: new Uint8Array([7, 8]),
    list: [{ name: "left_elbow" }],
    image: new Uint8Array(10_000).fill(9),
  };
  expect(hasText(message, text)).toBe(expected);
  expect(hasText(message, "9")).toBe(false);
});
