import { expect, it } from "vitest";
import { sideAt } from "./pane_drag";

it.each([
  [0.1, 0.5, "left"],
  [0.9, 0.5, "right"],
  [0.4, 0.2, "above"],
  [0.6, 0.8, "below"],
])("a pane that is dropped at %f, %f is %s", (x, y, side) => {
  expect(sideAt(x, y)).toBe(side);
});
