import { beforeEach, describe, expect, it } from "vitest";
import { Clock } from "../clock";
import { greatest } from "../lists";
import type { Subscriber } from "../messages/feed";
import { Outbox } from "../messages/outbox";
import type { Fields } from "../messages/reader";
import type { Batch } from "../messages/worker_messages";
import { openSamples, timeOf } from "./remote_sampler";
import type { Report, Request } from "./sample_messages";
import { Curve, type Recorder, Sampler } from "./sampler";

/** The worker, with a source of messages that records its calls. */
class FakeHub {
  readonly clock = new Clock();
  readonly calls: string[] = [];
  subscriber: Subscriber | undefined;
  #listener: (report: Report) => void = () => undefined;
  readonly #outbox = new Outbox((report) => {
    if ("why" in report) this.#listener(report as Report);
    if (!("reports" in report)) return;
    for (const each of (report as Batch).reports) this.#listener(each as Report);
    queueMicrotask(() => this.#outbox.taken());
  });

  /** Let messages come at a time in ms. */
  receive(message: Fields, time = 1000): void {
    this.deliver(message, time);
    this.flush();
  }

  deliver(message: Fields, time: number): void {
    void this.subscriber?.receive({ message, time, size: 1, node: "" });
  }

  /** Let the page have what was read. */
  flush(): void {
    this.#outbox.post({ kind: "clock" });
  }

  jump(): void {
    this.subscriber?.jump?.();
    this.flush();
    this.clock.jump();
  }

  readonly open = (request: unknown, _: Transferable[], listener: unknown) => {
    this.#listener = listener as (report: Report) => void;
    const subscribe = (subscriber: Subscriber) => {
      this.calls.push(`subscribe ${subscriber.topic} ${subscriber.throttle} ${subscriber.queue}`);
      this.subscriber = subscriber;
      return () => this.calls.push(`unsubscribe ${subscriber.topic}`);
    };
    const opened = { ...(request as object), id: 1 } as Request & { kind: "samples" };
    const next = openSamples({ subscribe }, opened, this.#outbox);
    return (more: object) => {
      next({ ...more, id: 1 } as Request);
      this.flush();
    };
  };
}

let hub: FakeHub;
let sampler: Sampler;
/** How often the sampler has reported samples. */
let changes: number;
/** What the sampler has found twice. */
let twins: Recorder[];

beforeEach(() => {
  hub = new FakeHub();
  changes = 0;
  twins = [];
  const source = hub as unknown as ConstructorParameters<typeof Sampler>[0];
  const changed = (): void => {
    changes += 1;
  };
  sampler = new Sampler(source, "/n", changed, (twin) => twins.push(twin));
});

describe("a sampler", () => {
  it("records the numbers of messages, and names a path that has none", () => {
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
    sampler.add(new Curve("x"));
    sampler.start();
    hub.receive({ x: 8, y: 5 });
    expect(sampler.add(new Curve("y")).samples.newest).toBe(5);
  });

  it("subscribes between start and stop, and leaves a gap", () => {
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
    const { samples } = sampler.add(new Curve("data"));
    sampler.start();
    const count = 30 * rate;
    const spike = (at: number): boolean => at % 203 === 0;
    for (let at = 0; at < count; at += 1)
      hub.deliver({ data: spike(at) ? 100 : 0 }, 1e12 + (1000 * at) / rate);
    hub.flush();
    // They came in few batches.
    expect(changes).toBeLessThan(10);
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

  it("begins again after a jump in time, also with what came before it", () => {
    const speed = sampler.add(new Curve("derivative(x)"));
    sampler.start();
    hub.receive({ x: 1 }, 1000);
    hub.receive({ x: 2 }, 2000);
    hub.deliver({ x: 3 }, 3000);
    hub.jump();
    expect(speed.samples.length).toBe(0);
    hub.receive({ x: 100 }, 9000);
    expect(speed.samples.length).toBe(0);
    expect(sampler.add(new Curve("x")).samples.newest).toBe(100);
    hub.receive({ x: 102 }, 10_000);
    expect(speed.samples.newest).toBe(2);
  });

  it("knows a curve by its index and by its name", () => {
    const curve = sampler.add(new Curve("position[1]"));
    sampler.start();
    hub.receive({ name: ["shoulder", "elbow"], position: [1, 2] });
    expect(
      ["position[1]", "position[elbow]", "position[0]"].map((each) => curve.isOf(each)),
    ).toEqual([true, true, false]);
  });

  it("asks for a longer time before a moment, unless that is the present", () => {
    const { samples } = sampler.add(new Curve("x"));
    sampler.reach(30);
    sampler.start();
    hub.receive({ x: 1 });
    sampler.reach(120);
    expect([hub.subscriber?.span, samples.length, hub.calls.length]).toEqual([30_000, 1, 1]);
    hub.clock.report({ ...hub.clock.playback.value, isLive: false });
    sampler.reach(600);
    expect([hub.subscriber?.span, samples.length]).toEqual([600_000, 0]);
    sampler.reach(10);
    expect(hub.calls.length).toBe(3);
  });

  it("finds a curve that is there by its name when it is added by its index", () => {
    sampler.add(new Curve("position[elbow]"));
    sampler.start();
    hub.receive({ name: ["shoulder", "elbow"], position: [1, 2] });
    sampler.add(new Curve("position[0]"));
    expect(twins).toEqual([]);
    const curve = sampler.add(new Curve("position[1]"));
    expect(twins).toEqual([curve]);
  });

  it("keeps the reason for a rejection", () => {
    sampler.start();
    hub.subscriber?.fail("no such type");
    expect(sampler.error).toBe("no such type");
  });
});

describe("the time of a sample", () => {
  it("is that of the header if it is close to now", () => {
    expect(timeOf(998.5, 1000)).toBe(998.5);
    expect(timeOf(1, 1000)).toBe(1000);
    expect(timeOf(undefined, 1000)).toBe(1000);
  });
});
