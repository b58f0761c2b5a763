import { describe, expect, it } from "vitest";
import {
  applied,
  between,
  IDENTITY,
  inverse,
  multiplied,
  type Quaternion,
  rollPitchYaw,
  type Transform,
  turned,
  unit,
} from "./transforms";

function at(x: number, y: number, rotation: Quaternion): Transform {
  return { translation: { x, y, z: 0 }, rotation };
}

const LEFT = turned(Math.PI / 2);

describe("transforms", () => {
  it("apply the rotation before the translation", () => {
    const { x, y, z } = applied(at(1, 2, LEFT), { x: 1, y: 0, z: 5 });
    expect([x, y, z].map((each) => Math.round(each * 1e9) / 1e9)).toEqual([1, 3, 5]);
  });

  it("end where they began after their inverse", () => {
    const transform = at(3, -2, unit(at(0, 0, { x: 0.3, y: -0.2, z: 0.5, w: 0.7 })).rotation);
    const back = multiplied(inverse(transform), transform);
    for (const each of [back.translation.x, back.translation.y, back.rotation.x, back.rotation.z]) {
      expect(each).toBeCloseTo(0);
    }
    expect(back.rotation.w).toBeCloseTo(1);
  });

  it("have no rotation if their quaternion is zero or not finite, and else one of length 1", () => {
    const rotation = (x: number, y: number, z: number, w: number): Quaternion =>
      unit(at(0, 0, { x, y, z, w })).rotation;
    expect(rotation(0, 0, 0, 0)).toEqual(IDENTITY.rotation);
    expect(rotation(Number.NaN, 0, 0, 1)).toEqual(IDENTITY.rotation);
    expect(rotation(0, 0, 3, 4)).toEqual({ x: 0, y: 0, z: 0.6, w: 0.8 });
    // Its numbers add up to zero, but it is half a turn.
    expect(rotation(1, -1, 0, 0).x).toBeCloseTo(Math.SQRT1_2);
  });

  it("are interpolated the shorter way", () => {
    const { z, w } = turned(Math.PI / 2);
    const half = between(at(0, 0, IDENTITY.rotation), at(2, 4, { x: 0, y: 0, z: -z, w: -w }), 0.5);
    expect(half.translation).toEqual({ x: 1, y: 2, z: 0 });
    expect(rollPitchYaw(half.rotation)[2]).toBeCloseTo(Math.PI / 4);
    const same = between(at(0, 0, LEFT), at(0, 0, LEFT), 0.3);
    expect(rollPitchYaw(same.rotation)[2]).toBeCloseTo(Math.PI / 2);
  });
});
