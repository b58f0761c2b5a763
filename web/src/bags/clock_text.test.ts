import { describe, expect, it } from "vitest";
import { clockText } from "./clock_text";

describe("clockText", () => {
  it.each([
    [-1, "0:00"],
    [5.9, "0:05"],
    [720, "12:00"],
    [3599, "59:59"],
    [3600, "1:00:00"],
    [90061, "25:01:01"],
  ])("shows %f s as %s", (seconds, text) => {
    expect(clockText(seconds)).toBe(text);
  });
});
