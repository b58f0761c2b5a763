import { describe, expect, it } from "vitest";
import {
  axisText,
  clock,
  linearExtent,
  logarithmicExtent,
  logarithmicTicks,
  notPositive,
} from "./axes";
import type { Samples } from "./ring_buffer";

function curve(values: number[]): Samples {
  return { times: Float64Array.from(values, (_, at) => at), values: Float64Array.from(values) };
}

describe("axes", () => {
  it("have a margin, except below zero", () => {
    expect(linearExtent([curve([0, 50]), curve([100, NaN])], 0)).toEqual([0, 108]);
    expect(linearExtent([curve([-50, 50])], 0)).toEqual([-58, 58]);
    expect(linearExtent([curve([4, 4])], 0)).toEqual([2, 6]);
    expect(linearExtent([curve([0])], 0)).toEqual([-1, 1]);
    expect(linearExtent([curve([])], 0)).toEqual([0, 1]);
  });

  it("ignore samples before the window", () => {
    expect(linearExtent([curve([1000, 0, 100])], 1.5)).toEqual([0, 108]);
  });

  it("extend to powers of ten if logarithmic", () => {
    expect(logarithmicExtent([curve([3, 250])], 0)).toEqual([1, 1000]);
    expect(logarithmicExtent([curve([10, 10])], 0)).toEqual([10, 100]);
    expect(logarithmicExtent([curve([NaN])], 0)).toEqual([1, 10]);
    expect(notPositive([curve([0, -1, 1]), curve([NaN])])).toBe(2);
  });

  it("have ticks at powers of ten and between them", () => {
    expect(logarithmicTicks([1, 100], 6)).toEqual([1, 2, 5, 10, 20, 50, 100]);
    expect(logarithmicTicks([1, 10_000], 4)).toEqual([1, 10, 100, 1000, 10_000]);
    expect(logarithmicTicks([1, 1e10], 5)).toEqual([1, 1e2, 1e4, 1e6, 1e8, 1e10]);
  });

  it("have short labels", () => {
    expect([0, 1200, 0.25, 1_800_000_000, -2e-7, 1e6].map(axisText)).toEqual([
      "0",
      "1200",
      "0.25",
      "1.8e9",
      "-2e-7",
      "1e6",
    ]);
    const secs = new Date(2026, 10, 21, 20, 35, 5).getTime() / 1000;
    expect(clock(secs)).toBe("20:35:05");
    expect(clock(secs + 0.5)).toBe("20:35:05.5");
  });
});
