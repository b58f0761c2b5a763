import { beforeEach, describe, expect, it } from "vitest";
import { rollPitchYaw, type TransformStamped, type Vector } from "../../transforms";
import { Frames, MAX_FRAMES } from "./frames";

const HALF = Math.SQRT1_2;
const UPRIGHT = { x: 0, y: 0, z: 0, w: 1 };
const LEFT = { x: 0, y: 0, z: HALF, w: HALF };

function stamped(
  parent: string,
  child: string,
  translation: Vector = { x: 0, y: 0, z: 0 },
  rotation = UPRIGHT,
): TransformStamped {
  const header = { stamp: { secs: 1, nsecs: 0 }, frame_id: parent };
  return { header, child_frame_id: child, transform: { translation, rotation } };
}

const MOVING = { node: "/driver", isStatic: false };
const STATIC = { node: "/mount", isStatic: true };

let frames: Frames;

beforeEach(() => {
  frames = new Frames();
});

function faults(name: string, now: number): string[] {
  const frame = frames.all.get(name);
  return frame === undefined ? ["missing"] : frames.faultsOf(frame, now);
}

describe("Frames", () => {
  it("finds where a frame is in another, over a common one", () => {
    frames.update([stamped("map", "/odom", { x: 10, y: 0, z: 0 }, LEFT)], MOVING, 0);
    frames.update([stamped("/odom", "base", { x: 1, y: 0, z: 0 })], MOVING, 0);
    frames.update([stamped("map", "goal", { x: 10, y: 5, z: 0 })], STATIC, 0);
    const base = frames.lookup("map", "base").translation;
    expect([base.x, base.y]).toEqual([expect.closeTo(10), expect.closeTo(1)]);
    // The goal is 4 m ahead of the robot, which looks to the left.
    const goal = frames.lookup("base", "goal");
    expect(goal.translation.x).toBeCloseTo(4);
    expect(goal.translation.y).toBeCloseTo(0);
    expect(rollPitchYaw(goal.rotation)[2]).toBeCloseTo(-Math.PI / 2);
    expect(frames.lookup("base", "base").translation).toEqual({ x: 0, y: 0, z: 0 });
  });

  it("says why there is no transform", () => {
    frames.update([stamped("map", "base"), stamped("world", "arm")], MOVING, 0);
    expect(() => frames.lookup("map", "arm")).toThrow("two trees: map and world");
    expect(() => frames.lookup("map", "lidar")).toThrow("unknown frame “lidar”");
  });

  it("has roots and children", () => {
    frames.update([stamped("map", "odom"), stamped("map", "goal"), stamped("w", "a")], MOVING, 0);
    expect(frames.roots()).toEqual(["map", "w"]);
    expect(frames.childrenOf("map").map(({ name }) => name)).toEqual(["goal", "odom"]);
    expect(frames.names).toEqual(["a", "goal", "map", "odom", "w"]);
  });

  it("measures rates", () => {
    for (let time = 0; time < 2000; time += 100) {
      frames.update([stamped("map", "base")], MOVING, time);
      frames.age(time);
    }
    expect(frames.all.get("base")?.rate).toBeCloseTo(10, 0);
  });

  it("finds what is wrong", () => {
    frames.update([stamped("map", "base"), stamped("a", "b"), stamped("b", "a")], MOVING, 0);
    frames.update([stamped("odom", "base")], { node: "/other", isStatic: false }, 100);
    frames.update([stamped("base", "lidar", undefined, { x: 0, y: 0, z: 0, w: 0 })], STATIC, 0);
    expect(faults("base", 200)).toEqual(["has several parents: map, odom"]);
    expect(faults("a", 200)).toEqual(["is in a loop"]);
    expect(faults("lidar", 9000)).toEqual(["the quaternion has the length 0, not 1"]);
    expect(faults("base", 3100)).toContain("no transform for 3 s");
    frames.update([stamped("odom", "base")], MOVING, 9000);
    frames.age(9000);
    expect(faults("base", 9000)).toEqual([]);
    expect(frames.roots()).toEqual(["a", "odom"]);
    // A rotation of length 0 counts as none.
    expect(frames.lookup("base", "lidar").rotation).toEqual(UPRIGHT);
  });

  it("is bounded", () => {
    const many = Array.from({ length: MAX_FRAMES + 5 }, (_, at) => stamped("map", `f${at}`));
    frames.update(many, MOVING, 0);
    expect(frames.all.size).toBe(MAX_FRAMES);
  });
});

it("rollPitchYaw is that of REP 103", () => {
  expect(rollPitchYaw(LEFT)[2]).toBeCloseTo(Math.PI / 2);
  expect(rollPitchYaw({ x: HALF, y: 0, z: 0, w: HALF })[0]).toBeCloseTo(Math.PI / 2);
  expect(rollPitchYaw({ x: 0, y: HALF, z: 0, w: HALF })[1]).toBeCloseTo(Math.PI / 2);
});
