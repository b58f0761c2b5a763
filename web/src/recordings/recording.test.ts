import { expect, it } from "vitest";
import type { Kept, Wish } from "../messages/store";
import { Unreachable } from "./ranges";
import { Channel, IndexedRecording, topicsOf } from "./recording";

const START = 1_700_000_000_000;

interface Read {
  readonly topics: string;
  readonly from: number;
  readonly to: number;
}

/** A recording of `[topic, second]` in parts of ten seconds, some of which are damaged. */
class Fake extends IndexedRecording {
  readonly topics;
  readonly start = START;
  readonly end: number;
  readonly reads: Read[] = [];
  readonly damaged = new Set<number>();
  readonly counted: { total: number };
  messageSize = 0;
  fault = (): Error => new Error("wrong checksum");
  #messages: Kept[];

  constructor(
    messages: readonly (readonly [string, number])[],
    end: number,
    counted = { total: 0 },
  ) {
    super(counted, () => undefined);
    this.counted = counted;
    const names = [...new Set(messages.map(([topic]) => topic))];
    const channels = new Map(names.map((name) => [name, new Channel(name, "t/T", "", "ros1")]));
    this.topics = topicsOf(channels.values());
    this.end = START + end * 1000;
    this.#messages = messages.map(([topic, second]) =>
      (channels.get(topic) as Channel).kept(START + second * 1000, new Uint8Array()),
    );
  }

  protected async *read(
    topics: readonly string[],
    from: number,
    to: number,
    isBack: boolean,
  ): AsyncGenerator<Kept> {
    const seconds = (time: number): number => (time - START) / 1000;
    this.reads.push({ topics: topics.join(), from: seconds(from), to: seconds(to) });
    const all = isBack ? this.#messages.toReversed() : this.#messages;
    for (const kept of all) {
      if (!topics.includes(kept.topic) || kept.time < from || kept.time > to) continue;
      if (this.damaged.has(Math.floor(seconds(kept.time) / 10))) throw this.fault();
      this.counted.total += this.messageSize;
      yield kept;
    }
  }

  protected leaveOut(topics: readonly string[], time: number, isBack: boolean): boolean {
    const part = Math.floor((time - START) / 10_000);
    const found = [...this.damaged].sort((a, b) => a - b);
    const next = isBack ? found.findLast((each) => each <= part) : found.find((x) => x >= part);
    if (next === undefined) return false;
    this.damaged.delete(next);
    this.#messages = this.#messages.filter(
      ({ topic, time }) => !topics.includes(topic) || Math.floor((time - START) / 10_000) !== next,
    );
    return true;
  }
}

function seconds(found: readonly Kept[]): string[] {
  return found.map(({ topic, time }) => `${topic} ${(time - START) / 1000}`);
}

function wish(count: number, span = 0): Wish {
  return { count, span };
}

function every(topic: string, step: number, end: number): [string, number][] {
  return Array.from({ length: Math.floor(end / step) + 1 }, (_, at) => [topic, at * step]);
}

it("the newest messages before a moment are found, also of a topic from long ago", async () => {
  const recording = new Fake([["/map", 0], ...every("/scan", 0.5, 5000)], 5000);
  const wanted = new Map([
    ["/map", wish(1)],
    ["/scan", wish(1)],
    ["/none", wish(1)],
  ]);
  const found = await recording.before(wanted, START + 4000_200);
  expect(seconds(found)).toEqual(["/map 0", "/scan 4000"]);
  // All topics of the last second, and then what is missing by itself.
  expect(recording.reads.map(({ topics }) => topics)).toEqual(["/map,/scan", "/map"]);
});

it("those who say so get all messages of a longer time", async () => {
  const recording = new Fake(every("/odom", 1, 1000), 1000);
  const wanted = new Map([["/odom", wish(10_000, 600_000)]]);
  const found = await recording.before(wanted, START + 700_000);
  expect(seconds([found[0], found.at(-1)] as Kept[])).toEqual(["/odom 100", "/odom 700"]);
  expect(found.length).toBe(601);
  // As far as the bytes go.
  recording.messageSize = 2 ** 20;
  expect((await recording.before(wanted, START + 700_000)).length).toBeLessThan(100);
});

it("those who want all messages get those of half a minute", async () => {
  const recording = new Fake(every("/odom", 1, 1000), 1000);
  const found = await recording.before(new Map([["/odom", wish(10_000)]]), START + 500_000);
  expect(seconds(found)).toEqual(
    every("/odom", 1, 1000)
      .slice(470, 501)
      .map((x) => x.join(" ")),
  );
  const few = await recording.before(new Map([["/odom", wish(3)]]), START + 500_000);
  expect(seconds(few)).toEqual(["/odom 498", "/odom 499", "/odom 500"]);
});

it("no more is read for them than some bytes, such as of images beside them", async () => {
  const recording = new Fake(every("/odom", 2, 1000), 1000);
  recording.messageSize = 10 * 2 ** 20;
  const found = await recording.before(new Map([["/odom", wish(10_000)]]), START + 500_000);
  expect(seconds(found)).toEqual(
    every("/odom", 2, 500)
      .slice(-8)
      .map((x) => x.join(" ")),
  );
});

it("all static transforms up to a moment are found", async () => {
  const recording = new Fake([...every("/tf_static", 100, 900), ["/a", 950]], 1000);
  const found = await recording.before(new Map([["/tf_static", wish(Infinity)]]), START + 250_000);
  expect(seconds(found)).toEqual(["/tf_static 0", "/tf_static 100", "/tf_static 200"]);
});

it("what is later than a moment follows, without that moment", async () => {
  const recording = new Fake(every("/a", 1, 5), 5);
  const found: Kept[] = [];
  for await (const kept of recording.after(new Set(["/a", "/none"]), START + 2000))
    found.push(kept);
  expect(seconds(found)).toEqual(["/a 3", "/a 4", "/a 5"]);
});

it("damaged parts are left out, with a warning", async () => {
  const recording = new Fake(every("/a", 5, 40), 40);
  recording.damaged.add(1).add(2);
  const found: Kept[] = [];
  for await (const kept of recording.after(new Set(["/a"]), START - 1)) found.push(kept);
  expect(seconds(found)).toEqual(["/a 0", "/a 5", "/a 30", "/a 35", "/a 40"]);
  expect(recording.warnings).toEqual(["a part of the file is left out: wrong checksum"]);
  expect(seconds(await recording.before(new Map([["/a", wish(1)]]), START + 29_000))).toEqual([
    "/a 5",
  ]);
});

it("nothing is left out while the server cannot be reached", async () => {
  const recording = new Fake(every("/a", 5, 40), 40);
  recording.damaged.add(1);
  recording.fault = () => new Unreachable("no network");
  const found: Kept[] = [];
  for await (const kept of recording.after(new Set(["/a"]), START - 1)) found.push(kept);
  expect(seconds(found)).toEqual(["/a 0", "/a 5"]);
  expect(recording.damaged.size).toBe(1);
  expect(recording.warnings[0]).toContain("no network");
});

it("serializations that are not known are named", () => {
  const channel = new Channel("/a", "t/T", "", "protobuf");
  expect(() => channel.kept(0, new Uint8Array()).read()).toThrow("protobuf");
});

it("types of ROS 2 have the names of ROS 1", () => {
  expect(new Channel("/a", "std_msgs/msg/String", "", "cdr").topic.type).toBe("std_msgs/String");
});
