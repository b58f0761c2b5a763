import { describe, expect, it } from "vitest";
import { greatest } from "../../../lists";
import type { Fields } from "../../../messages/reader";
import { packCloud } from "../cloud";
import { PALETTES, paletteBytes, parseColor, percentiles } from "../colors";
import { scanPoints } from "./laser_scan";
import { ellipse } from "./poses";

type Field = readonly [name: string, offset: number, datatype: number];

const XYZ: readonly Field[] = [
  ["x", 0, 7],
  ["y", 4, 7],
  ["z", 8, 7],
];

/** A cloud of points i, 2i, 3i; `write` adds to each of them. */
function cloud(
  step: number,
  fields: readonly Field[],
  write: (view: DataView, at: number, index: number) => void = () => undefined,
  { count = 3, bigEndian = false, padding = 0 } = {},
): Fields {
  // An odd place, as in a message behind a frame's name.
  const buffer = new ArrayBuffer(1 + count * step + padding);
  const data = new Uint8Array(buffer, 1);
  const view = new DataView(buffer, 1);
  const sizes = [0, 1, 1, 2, 2, 4, 4, 4, 8];
  for (let index = 0; index < count; index += 1) {
    for (const [axis, [, offset, datatype]] of fields.slice(0, 3).entries()) {
      const value = index * (axis + 1);
      const at = index * step + offset;
      if (sizes[datatype] === 8) view.setFloat64(at, value, !bigEndian);
      else view.setFloat32(at, value, !bigEndian);
    }
    write(view, index * step, index);
  }
  return {
    width: count,
    height: 1,
    point_step: step,
    row_step: count * step,
    is_bigendian: bigEndian,
    fields: fields.map(([name, offset, datatype]) => ({ name, offset, datatype, count: 1 })),
    data,
  };
}

const AUTO = { color: "auto", field: "intensity" };

/** The coordinates of a packed cloud. */
function places({ data, stride, offset, count }: ReturnType<typeof packCloud>): number[][] {
  const view = new DataView(data.buffer, data.byteOffset);
  return Array.from({ length: count }, (_, index) =>
    [0, 4, 8].map((at) => view.getFloat32(index * stride + offset + at, true)),
  );
}

const EXPECTED = [
  [0, 0, 0],
  [1, 2, 3],
  [2, 4, 6],
];

describe("packCloud", () => {
  it.each([16, 32, 48])("draws points of %i bytes as they are", (step) => {
    const message = cloud(step, XYZ);
    const packed = packCloud(message, AUTO, 1000);
    expect(packed.data).toBe(message.data);
    expect(packed).toMatchObject({ stride: step, count: 3, every: 1, paint: { kind: "z" } });
    expect(places(packed)).toEqual(EXPECTED);
  });

  it.each([
    [18, XYZ],
    [22, XYZ],
    [26, [["x", 0, 8] as const, ["y", 8, 8] as const, ["z", 16, 8] as const]],
    [20, [["x", 4, 7] as const, ["y", 0, 7] as const, ["z", 8, 7] as const]],
    [300, XYZ],
  ] as const)("packs points of %i bytes anew if WebGL does not take them", (step, fields) => {
    const packed = packCloud(cloud(step, fields), AUTO, 1000);
    expect(packed.stride).toBe(16);
    expect(places(packed)).toEqual(EXPECTED);
  });

  it("reads the other order of bytes, and rows with padding", () => {
    const turned = packCloud(cloud(16, XYZ, undefined, { bigEndian: true }), AUTO, 1000);
    expect(places(turned)).toEqual(EXPECTED);
    const rows = { ...cloud(16, XYZ, undefined, { count: 4 }), width: 1, height: 2, row_step: 32 };
    expect(places(packCloud(rows, AUTO, 1000))).toEqual([EXPECTED[0], EXPECTED[2]]);
  });

  it.each([
    [1, "setInt8", -3],
    [2, "setUint8", 200],
    [3, "setInt16", -300],
    [4, "setUint16", 60_000],
    [5, "setInt32", -70_000],
    [6, "setUint32", 70_000],
    [7, "setFloat32", 0.5],
    [8, "setFloat64", 0.25],
  ] as const)("colours by a field of datatype %i", (datatype, method, value) => {
    for (const step of [24, 22]) {
      const fields = [...XYZ, ["intensity", 12, datatype] as const];
      const message = cloud(step, fields, (view, at) => view[method](at + 12, value, true));
      const { paint, data, stride } = packCloud(message, AUTO, 1000);
      const isOwn = step === 24 && datatype !== 8;
      if (paint.kind !== "number") throw new Error(paint.kind);
      expect(data === message.data).toBe(isOwn);
      if (!isOwn) {
        expect(paint).toEqual({ kind: "number", offset: 12, type: "float32" });
        const view = new DataView(data.buffer, data.byteOffset);
        expect(view.getFloat32(stride + 12, true)).toBe(value);
      }
    }
  });

  it("takes the colours of rgb from its bytes", () => {
    const fields = [...XYZ, ["rgb", 12, 7] as const];
    const write = (view: DataView, at: number): void => view.setUint32(at + 12, 0x00112233, true);
    for (const step of [16, 18]) {
      const { data, stride, paint } = packCloud(cloud(step, fields, write), AUTO, 1000);
      expect(paint).toEqual({ kind: "bgr", offset: 12 });
      expect([...data.subarray(stride + 12, stride + 15)]).toEqual([0x33, 0x22, 0x11]);
    }
    const big = cloud(16, fields, (view, at) => view.setUint32(at + 12, 0x112233), {
      bigEndian: true,
    });
    const { data, stride } = packCloud(big, AUTO, 1000);
    expect([...data.subarray(stride + 12, stride + 15)]).toEqual([0x33, 0x22, 0x11]);
  });

  it("leaves points out beyond its limit, and says so", () => {
    const many = packCloud(cloud(16, XYZ, undefined, { count: 100 }), AUTO, 30);
    expect(many).toMatchObject({ count: 100, every: 4, isThinned: false });
    const wide = packCloud(cloud(128, XYZ, undefined, { count: 100 }), AUTO, 30);
    expect(wide).toMatchObject({ count: 25, every: 4, isThinned: true, total: 100 });
    expect(places(wide)[1]).toEqual([4, 8, 12]);
  });

  it("says what is wrong, and draws what there is", () => {
    const short = { ...cloud(16, XYZ), width: 10, row_step: 160 };
    const packed = packCloud(short, AUTO, 1000);
    expect(packed.count).toBe(3);
    expect(packed.fault).toBe("the data has 48 bytes, but 10 × 1 points take 160");
    expect(() => packCloud(cloud(16, XYZ.slice(0, 2)), AUTO, 1)).toThrow("no field z");
    const integers = [["x", 0, 5] as const, ...XYZ.slice(1)];
    expect(() => packCloud(cloud(16, integers), AUTO, 1)).toThrow("float32 or float64, got int32");
    const missing = packCloud(cloud(16, XYZ), { color: "field", field: "ring" }, 1000);
    expect(missing.fault).toBe("no field ring: there are x, y, z");
  });
});

describe("scanPoints", () => {
  const scan = { angle_min: 0, angle_increment: Math.PI / 2, range_min: 0.1, range_max: 5 };

  it("leaves out rays that have seen nothing, and finds the nearest", () => {
    const ranges = Float32Array.of(1, 2, 0.05, Infinity, Number.NaN, 6);
    const { numbers, count, nearest } = scanPoints({ ...scan, ranges, intensities: [] });
    expect(count).toBe(2);
    expect(numbers[5]).toBeCloseTo(0);
    expect(numbers[6]).toBeCloseTo(2);
    expect(nearest).toEqual({ range: 1, angle: 0 });
    // In JSON, null stands for numbers that are not finite.
    expect(scanPoints({ ...scan, ranges: [null, 2], intensities: [7, 8] })).toMatchObject({
      count: 1,
      nearest: { range: 2 },
    });
  });

  it("takes all echoes of a ray", () => {
    const ranges = [{ echoes: [1] }, { echoes: Float32Array.of(2, 3) }];
    const { numbers, count } = scanPoints({ ...scan, ranges, intensities: [] });
    expect(count).toBe(3);
    expect([numbers[6], numbers[11]]).toEqual([2, 3]);
  });
});

describe("colours", () => {
  it("of a map are those of RViz", () => {
    const bytes = paletteBytes();
    const row = PALETTES.indexOf("map") * 1024;
    const color = (value: number): number[] => [...bytes.subarray(row + value * 4).slice(0, 3)];
    expect(color(0)).toEqual([255, 255, 255]);
    expect(color(100)).toEqual([0, 0, 0]);
    expect(color(255)).toEqual([0x70, 0x89, 0x86]);
    expect(color(101)).toEqual([0, 255, 0]);
  });

  it("of turbo go from dark blue over green to dark red", () => {
    const bytes = paletteBytes();
    const strongest = (value: number): number => {
      const color = [...bytes.subarray(value * 4, value * 4 + 3)];
      return color.indexOf(greatest(color));
    };
    expect([10, 128, 250].map(strongest)).toEqual([2, 1, 0]);
  });

  it("are parsed, and limits found without a few extreme values", () => {
    expect(parseColor("#ff0080")).toEqual([1, 0, 128 / 255, 1]);
    const values = Array.from({ length: 1000 }, (_, at) => at);
    values[500] = 1e9;
    values[501] = Number.NaN;
    const [low, high] = percentiles(values.length, (at) => values[at] as number);
    expect(low).toBeLessThan(20);
    expect(high).toBeLessThan(1000);
    expect(percentiles(0, () => 0)).toEqual([0, 1]);
  });
});

describe("ellipse", () => {
  it("has the axes of a covariance", () => {
    expect(ellipse(4, 0, 1)).toEqual({ a: 2, b: 1, angle: 0 });
    const { a, b, angle } = ellipse(2.5, 1.5, 2.5);
    expect([a, b, angle]).toEqual([
      expect.closeTo(2),
      expect.closeTo(1),
      expect.closeTo(Math.PI / 4),
    ]);
  });
});
