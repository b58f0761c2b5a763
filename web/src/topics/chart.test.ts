import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Chart, type ChartCurve, type ChartStyle } from "./chart";
import { recording } from "./recording.fixture";
import { Curve } from "./sampler";

vi.mock("../script_urls", () => ({ dataWorker: "" }));
vi.mock("uplot", () => ({
  default: class {
    readonly over = fake();
    readonly bbox = { width: 400, height: 200 };
    readonly cursor = {};
    batch(work: () => void): void {
      work();
    }
    setScale(): void {}
    destroy(): void {}
  },
}));

const STYLE: ChartStyle = {
  ink: "",
  line: "",
  logarithmic: false,
  logarithmicAcross: false,
  separate: false,
  shape: "lines",
  across: "time",
};

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
    prepend: nothing,
    classList: { toggle: nothing },
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

function curve(...values: number[]): ChartCurve {
  const made = new Curve("x");
  const record = recording(made);
  for (const [at, x] of values.entries()) record({ x }, at + 1);
  return { curve: made, style: 0, colour: "red" };
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

it("forgets which curve was flat when they are gone", () => {
  const chart = shown();
  chart.set([curve(0, 1), curve(0, 1000)], STYLE);
  chart.draw(3, 10, false);
  expect(chart.hasFlatCurve).toBe(true);
  chart.set([], STYLE);
  chart.draw(3, 10, false);
  expect(chart.hasFlatCurve).toBe(false);
});

it("has its remarks again once the same curves are drawn in another style", () => {
  const chart = shown();
  const curves = [curve(0, 1), curve(0, 1000)];
  chart.set(curves, STYLE);
  chart.draw(3, 10, false);
  chart.set(curves, { ...STYLE, ink: "white" });
  chart.draw(3, 10, false);
  expect(chart.hasFlatCurve).toBe(true);
});
