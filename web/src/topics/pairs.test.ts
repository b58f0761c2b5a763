import { expect, it } from "vitest";
import { pairs } from "./pairs";
import { RingBuffer } from "./ring_buffer";

function buffer(...samples: [time: number, value: number][]): RingBuffer {
  const ring = new RingBuffer(99);
  for (const [time, value] of samples) ring.push(time, value);
  return ring;
}

it("pairs samples of one message, also of those that have the same time", () => {
  const x = buffer([1, 10], [2, 20], [2, 21], [2, 22], [3, 30]);
  const y = buffer([1, 1], [2, 2], [2, 3], [2, 4], [3, 5]);
  const { xs, ys } = pairs(x, y, 0, 9);
  expect([...xs]).toEqual([10, 20, 21, 22, 30]);
  expect([...ys]).toEqual([1, 2, 3, 4, 5]);
});

it("pairs samples of other topics with the newest value until then", () => {
  const x = buffer([1, 10], [2, 20], [2.2, 22], [4, 40]);
  const y = buffer([0.5, 0], [1.5, 1], [3, 2], [5, 3], [6, 4]);
  const { xs, ys } = pairs(x, y, 0, 5.5);
  expect([...xs]).toEqual([NaN, 10, 22, 40]);
  expect([...ys]).toEqual([0, 1, 2, 3]);
});

it("begins in the middle, with the value from before", () => {
  const { xs } = pairs(buffer([1, 10], [9, 90]), buffer([1, 1], [5, 5]), 4, 6);
  expect([...xs]).toEqual([10]);
});
