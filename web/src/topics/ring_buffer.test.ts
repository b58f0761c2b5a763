import { describe, expect, it } from "vitest";
import { greatest, least } from "../lists";
import { RingBuffer } from "./ring_buffer";

function filled(capacity: number, count: number, value = (at: number): number => at): RingBuffer {
  const ring = new RingBuffer(capacity);
  for (let at = 0; at < count; at += 1) ring.push(at, value(at));
  return ring;
}

describe("a ring buffer", () => {
  it("keeps only the newest samples", () => {
    const ring = filled(4, 10);
    expect(ring.length).toBe(4);
    expect(ring.first).toBe(6);
    expect(ring.newest).toBe(9);
    expect([...ring.between(-1, 99, 100).values]).toEqual([6, 7, 8, 9]);
    ring.clear();
    expect([ring.length, ring.first, ring.newest]).toEqual([0, undefined, undefined]);
  });

  it("returns the samples between two times and their neighbours", () => {
    const ring = filled(100, 10);
    expect([...ring.between(3.5, 5.5, 100).times]).toEqual([3, 4, 5, 6]);
    expect([...ring.between(20, 30, 100).times]).toEqual([9]);
    expect([...new RingBuffer(3).between(0, 9, 100).times]).toEqual([]);
  });

  it("returns the samples since an index, as far as it has them", () => {
    const ring = filled(4, 10);
    expect(ring.after(7.5)).toBe(8);
    expect([...ring.slice(8, 10).values]).toEqual([8, 9]);
    expect([...ring.slice(2, 8).values]).toEqual([6, 7]);
    expect([...ring.slice(10, 10).values]).toEqual([]);
  });

  it("keeps all peaks when it thins out samples", () => {
    const ring = filled(10_000, 10_000, (at) => (at === 4321 ? 99 : at === 4322 ? -99 : at % 2));
    const { times, values } = ring.between(0, 10_000, 500);
    expect(values.length).toBeLessThanOrEqual(502);
    expect(greatest(values)).toBe(99);
    expect(least(values)).toBe(-99);
    expect([...times]).toEqual([...times].sort((a, b) => a - b));
  });

  it("chooses the same samples for a slightly later range", () => {
    const ring = filled(10_000, 9000, (at) => Math.sin(at * at));
    const before = [...ring.between(100, 8000, 500).times];
    const after = new Set(ring.between(164, 8064, 500).times);
    expect(
      before.filter((time) => time > 300 && time < 7900).every((time) => after.has(time)),
    ).toBe(true);
  });

  it("never decreases its times", () => {
    const ring = new RingBuffer(4);
    ring.push(5, 1);
    ring.push(3, 2);
    expect([...ring.between(0, 9, 9).times]).toEqual([5, 5]);
  });

  it("returns the value at a time", () => {
    const ring = filled(4, 10);
    expect(ring.valueAt(7.5)).toBe(7);
    expect(ring.valueAt(7)).toBe(7);
    expect(ring.valueAt(100)).toBe(9);
    expect(ring.valueAt(5)).toBeUndefined();
  });

  it("returns the samples between two times alone, and their extent", () => {
    const ring = filled(8, 12, (at) => (at === 6 ? NaN : at === 7 ? Infinity : at));
    expect([...ring.within(5, 8).values]).toEqual([5, NaN, Infinity, 8]);
    expect(ring.extent(5, 8.5)).toEqual([5, 8]);
    expect([...ring.all(4.5, 6)]).toEqual([
      { time: 5, value: 5 },
      { time: 6, value: NaN },
    ]);
    expect([...ring.within(20, 30).values]).toEqual([]);
    expect(ring.extent(6, 7)).toEqual([Infinity, -Infinity]);
  });

  it("has room for many samples only once there are many", () => {
    const ring = filled(5000, 3000);
    expect([ring.length, ring.first, ring.newest]).toEqual([3000, 0, 2999]);
    for (let at = 3000; at < 7000; at += 1) ring.push(at, at);
    expect([...ring.all()].map(({ value }) => value)).toEqual(
      Array.from({ length: 5000 }, (_, at) => 2000 + at),
    );
  });

  it("keeps integers of 64 bits, negative zero, NaN and gaps", () => {
    const ring = new RingBuffer(4);
    const sent = [1, 2n ** 63n - 1n, -(2n ** 63n), -0, NaN];
    for (const value of sent) ring.push(1, value);
    expect([...ring.all()].map(({ value }) => value)).toEqual(sent.slice(1));
    ring.pushGap(2);
    expect(ring.newest).toBeUndefined();
    ring.push(3, 7n);
    expect([ring.newest, ring.valueAt(2.5)]).toEqual([7n, undefined]);
  });

  it("keeps peaks beside numbers that cannot be drawn", () => {
    const odd = (at: number): number => [NaN, Infinity, -Infinity][at % 3] as number;
    const ring = filled(10_000, 9000, (at) => (at === 4321 ? 99 : at % 2 === 0 ? odd(at) : 0));
    const { values } = ring.between(0, 10_000, 500);
    expect([...values]).toContain(99);
    expect([...values]).toContain(0);
  });
});
