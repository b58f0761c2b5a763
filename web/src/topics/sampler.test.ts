import { describe, expect, it, vi } from "vitest";
import { Clock } from "../clock";
import type { Message } from "../hub";
import { greatest } from "../lists";
import type { Wanted } from "../messages/data_client";
import type { DataSource } from "../source";
import { plotSource } from "./plot_source";
import { Curve, Sampler, timeOf } from "./sampler";

vi.mock("../messages/data_client", () => ({
  subscribe: (fake: FakeHub, ...rest: Parameters<FakeHub["subscribe"]>) => fake.subscribe(...rest),
}));

/** A source of messages that records its calls. */
class FakeHub {
  readonly clock = new Clock();
  #listener: (message: Message, delivery: { time: number }) => void = () => undefined;
  reject: (why: string) => void = () => undefined;
  readonly calls: string[] = [];

  /** Let a message come at a time in ms. */
  receive(message: Message, time = 1000): void {
    this.#listener(message, { time });
  }

  subscribe(
    { topic, throttle = 0, queue = 1 }: Wanted,
    listener: (message: Message, delivery: { time: number }) => void,
    onError: (why: string) => void,
  ): () => void {
    this.calls.push(`subscribe ${topic} ${throttle} ${queue}`);
    this.#listener = listener;
    this.reject = onError;
    return () => this.calls.push(`unsubscribe ${topic}`);
  }
}

function create(): { hub: FakeHub; sampler: Sampler } {
  const hub = new FakeHub();
  return {
    hub,
    sampler: new Sampler(plotSource(hub as unknown as DataSource), "/n", () => undefined),
  };
}

describe("a sampler", () => {
  it("records the numbers of messages, and names a path that has none", () => {
    const { hub, sampler } = create();
    const x = sampler.add(new Curve("x"));
    const inner = sampler.add(new Curve("list[1]"));
    sampler.start();
    hub.receive({ x: 8, list: [1, 2] });
    expect([x.samples.newest, inner.samples.newest, sampler.missing]).toEqual([8, 2, ""]);
    hub.receive({ x: 13, list: [1] });
    expect([x.samples.newest, inner.samples.newest, sampler.missing]).toEqual([
      13,
      undefined,
      "list[1]",
    ]);
  });

  it("follows an element by its name", () => {
    const { hub, sampler } = create();
    const curve = sampler.add(new Curve("position[1]"));
    sampler.start();
    hub.receive({ name: ["shoulder", "elbow"], position: [1, 2] });
    expect([curve.path, curve.samples.newest]).toEqual(["position[elbow]", 2]);
    hub.receive({ name: ["wrist"], position: [9] });
    expect([curve.samples.length, sampler.missing]).toEqual([1, ""]);
    hub.receive({ name: ["elbow"], position: [3] });
    expect([curve.samples.newest, sampler.missing]).toEqual([3, ""]);
    hub.receive({ name: ["elbow"], position: [] });
    sampler.add(new Curve("position[hand]"));
    expect(sampler.missing).toBe("position[hand]");
  });

  it("begins again when stamps go back", () => {
    const { hub, sampler } = create();
    const { samples } = sampler.add(new Curve("x"));
    sampler.start();
    const at = (secs: number, x: number) =>
      hub.receive({ header: { stamp: { secs, nsecs: 0 } }, x });
    at(20, 1);
    at(21, 2);
    expect(samples.length).toBe(2);
    at(0, 3);
    expect(samples.length).toBe(3);
    at(1, 4);
    expect([samples.length, samples.newest]).toEqual([1, 4]);
  });

  it("has the newest elements of an array, and no samples", () => {
    const { hub, sampler } = create();
    const curve = sampler.add(new Curve("ranges[1:] * 2"));
    sampler.start();
    hub.receive({ ranges: [1, 2, 3] });
    expect([...(curve.elements ?? [])]).toEqual([4, 6]);
    hub.receive({ ranges: [1, 5] });
    expect([...(curve.elements ?? [])]).toEqual([10]);
    hub.receive({});
    expect([curve.samples.length, sampler.missing]).toEqual([0, "ranges[1:] * 2"]);
  });

  it("has no derivative over the time without a subscription", () => {
    const { hub, sampler } = create();
    const { samples } = sampler.add(new Curve("derivative(x)"));
    sampler.start();
    hub.receive({ x: 1 }, 1000);
    hub.receive({ x: 2 }, 2000);
    sampler.stop();
    sampler.start();
    hub.receive({ x: 99 }, 3000);
    expect(samples.newest).toBe(undefined);
    hub.receive({ x: 101 }, 4000);
    expect([...samples.all()].map(({ value }) => value)).toEqual([1, undefined, 2]);
    expect(sampler.missing).toBe("");
  });

  it("gives a new curve the newest message", () => {
    const { hub, sampler } = create();
    sampler.add(new Curve("x"));
    sampler.start();
    hub.receive({ x: 8, y: 5 });
    expect(sampler.add(new Curve("y")).samples.newest).toBe(5);
  });

  it("subscribes between start and stop, and leaves a gap", () => {
    const { hub, sampler } = create();
    const x = sampler.add(new Curve("x"));
    sampler.start();
    sampler.start();
    hub.receive({ x: 8 });
    expect(x.samples.newest).toBe(8);
    sampler.stop();
    expect(x.samples.newest).toBeUndefined();
    expect(sampler.remove(x)).toBe(true);
    expect(hub.calls).toEqual(["subscribe /n 0 10000", "unsubscribe /n"]);
  });

  it.each([200, 1000])("has every sample of 30 s at %i Hz, also of a busy page", (rate) => {
    const { hub, sampler } = create();
    const { samples } = sampler.add(new Curve("data"));
    sampler.start();
    const count = 30 * rate;
    const spike = (at: number): boolean => at % 203 === 0;
    for (let at = 0; at < count; at += 1)
      hub.receive({ data: spike(at) ? 100 : 0 }, 1e12 + (1000 * at) / rate);
    const all = [...samples.all()];
    expect(all.length).toBe(count);
    expect(all.every(({ value }, at) => value === (spike(at) ? 100 : 0))).toBe(true);
    expect(new Set(all.map(({ time }) => time)).size).toBe(count);
    // Each spike is drawn, though the picture has fewer columns than there are samples.
    const { times, values } = samples.between(0, Infinity, 600);
    expect(values.length).toBeLessThan(1000);
    expect(greatest(values)).toBe(100);
    const drawn = samples.slice(samples.after(0), samples.after(Infinity));
    expect(drawn.values.filter((value) => value === 100).length).toBe(Math.ceil(count / 203));
    expect([...times]).toEqual([...times].sort((one, other) => one - other));
  });

  it("keeps the reason for a rejection", () => {
    const { hub, sampler } = create();
    sampler.start();
    hub.reject("no such type");
    expect(sampler.error).toBe("no such type");
  });
});

describe("the time of a sample", () => {
  it("is that of the header if it is close to now", () => {
    const at = (secs: number): number =>
      timeOf({ header: { stamp: { secs, nsecs: 500_000_000 } } }, 1000);
    expect(at(998)).toBe(998.5);
    expect(at(1)).toBe(1000);
    expect(timeOf({ data: 1 }, 1000)).toBe(1000);
  });
});
