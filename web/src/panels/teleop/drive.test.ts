import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import {
  Drive,
  directionOf,
  directionOfGamepad,
  directionOfStick,
  INTERVAL,
  type Limits,
  type Velocity,
} from "./drive";

const LIMITS: Limits = { speed: 2, turn: 1, ramp: 0 };
const FORWARD = { forward: 1, left: 0, turn: 0 };
const ZERO = { forward: 0, left: 0, turn: 0 };

let sent: (Velocity | string)[];
let drive: Drive;

function make(limits: Limits): Drive {
  sent = [];
  return new Drive(limits, {
    begin: () => sent.push("begin"),
    send: (velocity) => sent.push(velocity),
    end: () => sent.push("end"),
  });
}

beforeEach(() => {
  vi.useFakeTimers();
  drive = make(LIMITS);
});

afterEach(() => {
  vi.useRealTimers();
});

describe("Drive", () => {
  it("sends while something is held, then one zero, then nothing", () => {
    drive.hold("stick", FORWARD);
    vi.advanceTimersByTime(2 * INTERVAL);
    drive.release("stick");
    drive.release("stick");
    drive.releaseAll();
    vi.advanceTimersByTime(20 * INTERVAL);
    const moving = { forward: 2, left: 0, turn: 0 };
    expect(sent).toEqual(["begin", moving, moving, moving, ZERO, "end"]);
  });

  it("is silent at rest", () => {
    drive.release("stick");
    drive.releaseAll();
    vi.advanceTimersByTime(20 * INTERVAL);
    expect(sent).toEqual([]);
  });

  it("speeds up by a ramp, and slows down at once", () => {
    drive = make({ speed: 2, turn: 1, ramp: (4 * INTERVAL) / 1000 });
    drive.hold("stick", FORWARD);
    vi.advanceTimersByTime(5 * INTERVAL);
    const speeds = () => sent.flatMap((each) => (typeof each === "string" ? [] : each.forward));
    expect(speeds()).toEqual([0.5, 1, 1.5, 2, 2, 2]);
    drive.hold("stick", { forward: 0.25, left: 0, turn: 0 });
    vi.advanceTimersByTime(INTERVAL);
    drive.hold("stick", { forward: -1, left: 0, turn: 0 });
    vi.advanceTimersByTime(2 * INTERVAL);
    expect(speeds().slice(6)).toEqual([0.5, -0.5, -1]);
  });

  it("adds what is held, up to the limits", () => {
    drive.hold("keys", { forward: 1, left: 0, turn: 0.5 });
    drive.hold("stick", { forward: 1, left: 0, turn: -0.25 });
    vi.advanceTimersByTime(INTERVAL);
    expect(sent.at(-1)).toEqual({ forward: 2, left: 0, turn: 0.25 });
    drive.release("stick");
    vi.advanceTimersByTime(INTERVAL);
    expect(sent.at(-1)).toEqual({ forward: 2, left: 0, turn: 0.5 });
  });

  it("stops until it is resumed, even if something is held", () => {
    drive.hold("stick", FORWARD);
    drive.stop();
    expect(sent.slice(2)).toEqual([ZERO, ZERO, ZERO, "end"]);
    drive.hold("stick", FORWARD);
    vi.advanceTimersByTime(20 * INTERVAL);
    expect(sent.length).toBe(6);
    expect(drive.isStopped).toBe(true);
    drive.resume();
    drive.hold("stick", FORWARD);
    expect(sent.at(-1)).toEqual({ forward: 2, left: 0, turn: 0 });
  });

  it("stops what others drive", () => {
    drive.stop();
    expect(sent).toEqual(["begin", ZERO, ZERO, ZERO, "end"]);
  });
});

describe("directions", () => {
  it("of keys are those of REP 103", () => {
    expect(directionOf("KeyW")).toEqual(FORWARD);
    expect(directionOf("ArrowLeft")).toEqual({ forward: 0, left: 0, turn: 1 });
    expect(directionOf("KeyX")).toBeUndefined();
  });

  it("of a stick stay within its circle", () => {
    expect(directionOfStick(0, -1, false)).toEqual(FORWARD);
    expect(directionOfStick(-0.5, 0, false)).toEqual({ forward: 0, left: 0, turn: 0.5 });
    expect(directionOfStick(-0.5, 0, true)).toEqual({ forward: 0, left: 0.5, turn: 0 });
    const corner = directionOfStick(3, -4, false);
    expect(corner.forward).toBeCloseTo(0.8);
    expect(corner.turn).toBeCloseTo(-0.6);
  });

  it("of a gamepad need a shoulder button, and have a dead zone", () => {
    const pad = (pressed: boolean, ...axes: number[]) =>
      ({
        axes,
        buttons: Array.from({ length: 6 }, (_, at) => ({ pressed: pressed && at === 5 })),
      }) as unknown as Gamepad;
    expect(directionOfGamepad(pad(false, 0, -1))).toBeUndefined();
    expect(directionOfGamepad(pad(true, 0.05, -1, 1))).toEqual({ forward: 1, left: 0, turn: -1 });
    expect(directionOfGamepad(pad(true, 0.55, 0, 0))?.left).toBeCloseTo(-0.5);
    expect(directionOfGamepad(pad(true))).toEqual(ZERO);
  });
});
