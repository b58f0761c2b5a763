import { expect, test } from "vitest";
import { curvesFrom, curvesText } from "./plot_state";

test.each([
  [[["/pose", "position.x"]]],
  [
    [
      ["/a", "x"],
      ["/joint_states", "position[elbow, left]"],
      ["/b", "status[100 %2C].level"],
    ],
  ],
] as const)("curves %j survive a round trip", (curves) => {
  expect(curvesFrom(curvesText(curves))).toEqual(curves);
});

test("entries that are no curves are left out", () => {
  expect(curvesFrom("")).toEqual([]);
  expect(curvesFrom("/a,:x,/b:,/c:x")).toEqual([["/c", "x"]]);
});
