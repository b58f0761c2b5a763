import { expect, test } from "vitest";
import { csv, curvesFrom, curvesText, elementsCsv } from "./plot_state";
import { RingBuffer } from "./ring_buffer";

test.each([
  [[["/pose", "position.x"]]],
  [
    [
      ["/a", "x"],
      ["/joint_states", "position[elbow, left]"],
      ["/b", "status[100 %2C].level"],
      ["/scan", "atan2(ranges[:], 2) * 3.6 + 1e-3 / 5"],
    ],
  ],
] as const)("curves %j survive a round trip", (curves) => {
  expect(curvesFrom(curvesText(curves))).toEqual(curves);
});

test("entries that are no curves are left out", () => {
  expect(curvesFrom("")).toEqual([]);
  expect(curvesFrom("/a,:x,/b:,/c:x")).toEqual([["/c", "x"]]);
});

test("samples of one time share a row of the CSV, and gaps are empty", () => {
  const samples = (...all: [number, number | undefined][]) => {
    const buffer = new RingBuffer(10);
    for (const [time, value] of all) {
      if (value === undefined) buffer.pushGap(time);
      else buffer.push(time, value);
    }
    return buffer.all();
  };
  const text = csv([
    { name: ["/pose", "x"], samples: samples([1, 0.5], [2, undefined], [3, 1e-9]) },
    { name: ["/joints", 'position[a "b", c]'], samples: samples([1, 7], [2.5, -2]) },
  ]);
  expect(text.split("\r\n")).toEqual([
    'time,"/pose x","/joints position[a ""b"", c]"',
    "1.000000,0.5,7",
    "2.500000,,-2",
    "3.000000,1e-9,",
    "",
  ]);
  expect(csv([])).toBe("time\r\n");
});

test("the CSV has several samples of one time, and only what the buffer still has", () => {
  const buffer = new RingBuffer(2);
  for (const value of [1, 2, 3]) buffer.push(5, value);
  expect(csv([{ name: ["/a", "x"], samples: buffer.all() }])).toBe(
    'time,"/a x"\r\n5.000000,2\r\n5.000000,3\r\n',
  );
});

test("numbers of the CSV are as they were sent", () => {
  const buffer = new RingBuffer(10);
  const sent = [9007199254740993n, -0, NaN, Infinity, -Infinity, 2n ** 64n - 1n];
  for (const value of sent) buffer.push(1, value);
  const rows = csv([{ name: ["/a", "x"], samples: buffer.all() }]).split("\r\n");
  expect(rows.slice(1, -1).map((row) => row.split(",")[1])).toEqual([
    "9007199254740993",
    "-0",
    "nan",
    "inf",
    "-inf",
    "18446744073709551615",
  ]);
});

test("arrays are columns over their index, or over a part of it", () => {
  const curves = [
    { name: ["/scan", "ranges[:]"], elements: Float64Array.of(1, Infinity, 3) },
    { name: ["/b", "x[:]"], elements: Float64Array.of(0.5) },
  ] as const;
  expect(elementsCsv(curves).split("\r\n")).toEqual([
    'index,"/scan ranges[:]","/b x[:]"',
    "0,1,0.5",
    "1,inf,",
    "2,3,",
    "",
  ]);
  expect(elementsCsv(curves, 0.5, 1).split("\r\n").slice(1, -1)).toEqual(["1,inf,"]);
});
