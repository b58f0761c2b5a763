import { describe, expect, it } from "vitest";
import { SimulatedTime, Stamps } from "./simulated_time";

describe("simulated time", () => {
  it("is unknown before the first message of /clock", () => {
    expect(new SimulatedTime().now(1000)).toBeUndefined();
  });

  it("goes on between messages at the speed of the last two", () => {
    const time = new SimulatedTime();
    time.receive(20_000, 1000);
    expect(time.now(1020)).toBe(20_000);
    time.receive(21_000, 1100);
    expect(time.now(1120)).toBe(21_200);
    expect(time.now(999_000)).toBe(22_000);
  });

  it("stands still while the clock does, and follows it back", () => {
    const time = new SimulatedTime();
    time.receive(20_000, 1000);
    time.receive(20_000, 1100);
    expect(time.now(1150)).toBe(20_000);
    time.receive(500, 1200);
    expect(time.now(1200)).toBe(500);
    expect(time.now(1300)).toBe(500);
  });
});

describe("stamps", () => {
  it("go back when a bag begins again, not when two nodes take turns", () => {
    const stamps = new Stamps();
    const times = [20, 21, undefined, 20.95, 0, 21, 0, 0.5, 0.6, 20, 19];
    expect(times.filter((each) => stamps.hasGoneBack(each))).toEqual([0.5, 19]);
  });
});
