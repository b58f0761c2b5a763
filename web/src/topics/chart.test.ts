import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Chart, type ChartStyle } from "./chart";
import { RingBuffer } from "./ring_buffer";

const STYLE: ChartStyle = { ink: "", line: "", logarithmic: false, separate: false };

/** An element, or the context of a canvas, of which nothing is seen. */
function fake(): unknown {
  const context = new Proxy(
    {},
    { get: (_, name) => () => (name === "measureText" ? { width: 9 } : undefined) },
  );
  const nothing = (): void => undefined;
  return {
    style: {},
    clientWidth: 400,
    clientHeight: 200,
    getContext: () => context,
    append: nothing,
    setAttribute: nothing,
    addEventListener: nothing,
  };
}

/** A chart that has its size. */
function shown(): Chart {
  let resized: () => void = () => undefined;
  vi.stubGlobal(
    "ResizeObserver",
    class {
      constructor(changed: () => void) {
        resized = changed;
      }

      observe(): void {
        resized();
      }
    },
  );
  return new Chart(() => undefined);
}

function curve(...values: number[]): { samples: RingBuffer; style: number; colour: string } {
  const samples = new RingBuffer(9);
  for (const [at, value] of values.entries()) samples.push(at + 1, value);
  return { samples, style: 0, colour: "red" };
}

beforeEach(() => {
  vi.stubGlobal("document", { createElement: fake });
  vi.stubGlobal("devicePixelRatio", 1);
});

afterEach(() => {
  vi.unstubAllGlobals();
});

it("forgets that values have no logarithm when they, or the logarithm, are gone", () => {
  const chart = shown();
  chart.set([curve(-1, 1)], { ...STYLE, logarithmic: true });
  chart.draw(3, 10, false);
  expect(chart.isOffLogarithm).toBe(true);
  // Nothing is drawn without curves.
  chart.set([], { ...STYLE, logarithmic: true });
  chart.draw(3, 10, false);
  expect(chart.isOffLogarithm).toBe(false);
});

it("forgets which curve was flat, and the axes of curves, when they are gone", () => {
  const chart = shown();
  chart.set([curve(0, 1), curve(0, 1000)], STYLE);
  chart.draw(3, 10, false);
  expect(chart.hasFlatCurve).toBe(true);
  expect(chart.extents.length).toBe(2);
  chart.set([], STYLE);
  chart.draw(3, 10, false);
  expect(chart.hasFlatCurve).toBe(false);
  expect(chart.extents).toEqual([]);
});

it("has its axes and remarks again once the same curves are drawn in another style", () => {
  const chart = shown();
  const curves = [curve(0, 1), curve(0, 1000)];
  chart.set(curves, STYLE);
  chart.draw(3, 10, false);
  const { extents } = chart;
  chart.set(curves, { ...STYLE, ink: "white" });
  chart.draw(3, 10, false);
  expect(chart.hasFlatCurve).toBe(true);
  expect(chart.extents).toEqual(extents);
});
