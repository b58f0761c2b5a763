import { beforeEach, describe, expect, it } from "vitest";
import { turned, type Vector } from "../../transforms";
import { Camera } from "./camera";

let camera: Camera;

beforeEach(() => {
  camera = new Camera();
  camera.resize(800, 600);
});

function spot(x: number, y: number, z = 0): { x: number; y: number } {
  const found = camera.project({ x, y, z });
  if (found === undefined) throw new Error("behind the camera");
  return found;
}

function ground(x: number, y: number): Vector {
  const found = camera.ground(x, y);
  if (found === undefined) throw new Error("above the horizon");
  return found;
}

describe("Camera", () => {
  it("looks at the focus from behind, along x, with y to the left and z up", () => {
    expect(spot(0, 0).x).toBeCloseTo(400);
    expect(spot(0, 0).y).toBeCloseTo(300);
    expect(spot(2, 0).y).toBeLessThan(300);
    expect(spot(0, 2).x).toBeLessThan(400);
    expect(spot(0, 0, 2).y).toBeLessThan(300);
    expect(camera.project({ x: -50, y: 0, z: 0 })).toBeUndefined();
  });

  it("looks straight down, with x to the right and y up, as on a map", () => {
    camera.look("top");
    expect(spot(2, 0).x).toBeGreaterThan(400);
    expect(spot(2, 0).y).toBeCloseTo(300);
    expect(spot(0, 2).y).toBeLessThan(300);
    // What is high is in front of the ground, and at the same place.
    expect(spot(1, 1, 5).x).toBeCloseTo(spot(1, 1).x);
    expect(camera.project({ x: 1, y: 1, z: 5 })?.depth).toBeLessThan(
      camera.project({ x: 1, y: 1, z: 0 })?.depth ?? 0,
    );
  });

  it.each(["orbit", "top"] as const)("finds the ground under a pixel in %s", (mode) => {
    camera.mode = mode;
    camera.turn(37, 11);
    for (const [x, y] of [
      [1, 2],
      [-1.5, 0.5],
    ] as const) {
      const at = spot(x, y);
      const found = ground(at.x, at.y);
      expect([found.x, found.y]).toEqual([expect.closeTo(x), expect.closeTo(y)]);
    }
    expect(camera.ground(400, -3000) === undefined).toBe(mode === "orbit");
  });

  it.each(["orbit", "top"] as const)("zooms to what is under the pointer in %s", (mode) => {
    camera.mode = mode;
    const before = ground(600, 450);
    camera.zoom(0.5, 600, 450);
    const after = ground(600, 450);
    expect([after.x, after.y]).toEqual([expect.closeTo(before.x), expect.closeTo(before.y)]);
    expect(camera.distance).toBe(5);
  });

  it("moves the ground with the pointer when it looks down", () => {
    camera.look("top");
    const before = ground(400, 300);
    camera.pan(30, -20);
    const after = ground(430, 280);
    expect([after.x, after.y]).toEqual([expect.closeTo(before.x), expect.closeTo(before.y)]);
  });

  it("follows a frame, and how it is turned", () => {
    const robot = { translation: { x: 3, y: 4, z: 0 }, rotation: turned(Math.PI / 2) };
    const before = spot(3, 4);
    expect(camera.follow("heading", robot, true)).toBe(true);
    expect(spot(3, 4).x).toBeCloseTo(before.x);
    expect(spot(3, 4).y).toBeCloseTo(before.y);
    expect(camera.follow("heading", robot)).toBe(false);
    camera.follow("heading", { ...robot, translation: { x: 5, y: 4, z: 0 } });
    expect(spot(5, 4).x).toBeCloseTo(before.x);
    camera.follow("off", undefined, true);
    expect(spot(5, 4).x).toBeCloseTo(before.x);
  });

  it.each(["orbit", "top"] as const)("brings what it follows into the middle in %s", (mode) => {
    const robot = { translation: { x: 3, y: 4, z: 0 }, rotation: turned(Math.PI / 2) };
    camera.mode = mode;
    camera.turn(100, 0);
    camera.pan(70, 30);
    camera.follow("position", robot, true);
    const { heading } = camera;
    camera.recenter("position");
    expect(camera.center).toEqual({ x: 3, y: 4, z: 0 });
    expect(camera.heading).toBeCloseTo(heading);
    camera.follow("heading", robot, true);
    camera.recenter("heading");
    expect(camera.heading).toBeCloseTo(Math.PI / 2);
    expect(spot(3, 4).x).toBeCloseTo(400);
    // Its front is above it.
    expect(spot(3, 6).y).toBeLessThan(spot(3, 4).y);
  });

  it("begins behind the robot", () => {
    camera.placeBehind({ translation: { x: 3, y: 4, z: 0 }, rotation: turned(Math.PI / 2) });
    // It is below the middle of the picture, and its left is on the left.
    expect(spot(3, 4).x).toBeCloseTo(400);
    expect(spot(3, 4).y).toBeGreaterThan(300);
    expect(spot(2, 4).x).toBeLessThan(400);
  });

  it("takes a saved state, but for its invalid parts", () => {
    camera.turn(50, 20);
    const { state } = camera;
    const other = new Camera();
    other.restore(state);
    expect(other.state).toEqual(state);
    other.restore({ mode: "sideways", distance: Number.NaN, focus: [1, 2], yaw: "north" });
    expect(other.state).toEqual(state);
  });
});
