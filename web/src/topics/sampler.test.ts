import { describe, expect, it } from "vitest";
import type { Hub, Message, SubscribeOptions } from "../hub";
import { Sampler, timeOf } from "./sampler";

/** A hub that records its calls. */
class FakeHub {
  receive: (message: Message) => void = () => undefined;
  reject: (why: string) => void = () => undefined;
  readonly calls: string[] = [];

  subscribe(
    topic: string,
    options: SubscribeOptions,
    listener: (message: Message) => void,
    onError: (why: string) => void,
  ): () => void {
    this.calls.push(`subscribe ${topic} ${options.throttle}`);
    this.receive = listener;
    this.reject = onError;
    return () => this.calls.push(`unsubscribe ${topic}`);
  }
}

function create(): { hub: FakeHub; sampler: Sampler } {
  const hub = new FakeHub();
  return { hub, sampler: new Sampler(hub as unknown as Hub, "/n", 20, () => undefined) };
}

describe("a sampler", () => {
  it("records the numbers of messages, and names a path that has none", () => {
    const { hub, sampler } = create();
    const x = sampler.add("x");
    const inner = sampler.add("list[1]");
    sampler.start();
    hub.receive({ x: 8, list: [1, 2] });
    expect([x.samples.newest, inner.samples.newest, sampler.missing]).toEqual([8, 2, ""]);
    hub.receive({ x: 13, list: [1] });
    expect([x.samples.newest, inner.samples.newest, sampler.missing]).toEqual([13, NaN, "list[1]"]);
  });

  it("follows an element by its name", () => {
    const { hub, sampler } = create();
    const curve = sampler.add("position[1]");
    sampler.start();
    hub.receive({ name: ["shoulder", "elbow"], position: [1, 2] });
    expect([curve.path, curve.samples.newest]).toEqual(["position[elbow]", 2]);
    hub.receive({ name: ["wrist"], position: [9] });
    expect([curve.samples.length, sampler.missing]).toEqual([1, ""]);
    hub.receive({ name: ["elbow"], position: [3] });
    expect([curve.samples.newest, sampler.missing]).toEqual([3, ""]);
    hub.receive({ name: ["elbow"], position: [] });
    sampler.add("position[hand]");
    expect(sampler.missing).toBe("position[hand]");
  });

  it("begins again when stamps go back", () => {
    const { hub, sampler } = create();
    const { samples } = sampler.add("x");
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

  it("gives a new curve the newest message", () => {
    const { hub, sampler } = create();
    sampler.add("x");
    sampler.start();
    hub.receive({ x: 8, y: 5 });
    expect(sampler.add("y").samples.newest).toBe(5);
  });

  it("subscribes between start and stop, and leaves a gap", () => {
    const { hub, sampler } = create();
    const x = sampler.add("x");
    sampler.start();
    sampler.start();
    hub.receive({ x: 8 });
    sampler.throttle = 50;
    sampler.throttle = 50;
    expect(x.samples.newest).toBe(8);
    sampler.stop();
    expect(x.samples.newest).toBeNaN();
    expect(sampler.remove(x)).toBe(true);
    expect(hub.calls).toEqual([
      "subscribe /n 20",
      "unsubscribe /n",
      "subscribe /n 50",
      "unsubscribe /n",
    ]);
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
