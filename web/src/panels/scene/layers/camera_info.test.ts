import { expect, it } from "vitest";
import { frustum } from "./camera_info";

it("computes the corners of a picture from the camera's matrix", () => {
  const K = [100, 0, 50, 0, 200, 30, 0, 0, 1];
  const corners = frustum({ width: 100, height: 60, K }, 2);
  expect(corners).toEqual([
    { x: -1, y: -0.3, z: 2 },
    { x: 1, y: -0.3, z: 2 },
    { x: 1, y: 0.3, z: 2 },
    { x: -1, y: 0.3, z: 2 },
  ]);
});

it("says that a camera is not calibrated", () => {
  const K = new Array(9).fill(0);
  expect(() => frustum({ width: 100, height: 60, K }, 1)).toThrow("not calibrated");
});
