import { expect, it } from "vitest";
import { History } from "./history";
import type { Kept } from "./store";

/** A message of 800 bytes in memory. */
function message(topic: string, time: number): Kept {
  return { topic, type: "t/T", time, size: 600, node: "", read: () => ({ time }) };
}

function filled(limit: number, ...messages: readonly (readonly [string, number])[]): History {
  const history = new History(limit);
  for (const [topic, time] of messages) history.add(message(topic, time));
  return history;
}

async function before(history: History, wanted: Record<string, number>, time: number) {
  const wishes = Object.entries(wanted).map(
    ([topic, count]) => [topic, { count, span: 0 }] as const,
  );
  const found = await history.before(new Map(wishes), time);
  return found.map((kept) => `${kept.topic} ${kept.time}`);
}

async function after(history: History, topics: string[], time: number): Promise<string[]> {
  const found: string[] = [];
  for await (const kept of history.after(new Set(topics), time))
    found.push(`${kept.topic} ${kept.time}`);
  return found;
}

it("the newest messages of topics at a moment are found in their order", async () => {
  const history = filled(1e6, ["/a", 1], ["/b", 2], ["/a", 3], ["/c", 4], ["/a", 5]);
  expect(await before(history, { "/a": 1, "/b": 1, "/none": 1 }, 3)).toEqual(["/b 2", "/a 3"]);
  expect(await before(history, { "/a": 9 }, 5)).toEqual(["/a 1", "/a 3", "/a 5"]);
  expect(await before(history, { "/a": 1 }, 0.5)).toEqual([]);
  const long = await history.before(new Map([["/a", { count: 1, span: 3 }]]), 5);
  expect(long.map(({ time }) => time)).toEqual([3, 5]);
});

it("what follows a moment comes in order, also what is added meanwhile", async () => {
  const history = filled(1e6, ["/a", 1], ["/b", 2], ["/a", 3]);
  expect(await after(history, ["/a", "/b"], 1)).toEqual(["/b 2", "/a 3"]);
  const found: number[] = [];
  for await (const { time } of history.after(new Set(["/a"]), 0)) {
    found.push(time);
    if (found.length < 4) history.add(message("/a", time + 10));
  }
  expect(found).toEqual([1, 3, 11, 13, 21]);
});

it("static transforms count all, at any moment", async () => {
  const history = filled(1e6, ["/tf_static", 1], ["/tf_static", 2], ["/tf_static", 9]);
  expect(await before(history, { "/tf_static": 1 }, 5)).toEqual(["/tf_static 1", "/tf_static 2"]);
});

it("the oldest messages go when the memory is full, and the newest of each topic stay", async () => {
  const history = filled(3300, ["/map", 1], ["/tf_static", 2], ["/tf_static", 3]);
  for (let time = 10; time < 5000; time += 1) history.add(message("/scan", time));
  expect(history.bytes).toBeLessThanOrEqual(3300);
  const everything = { "/map": 9, "/tf_static": 9, "/scan": 9 };
  expect(await before(history, everything, 9999)).toEqual([
    "/map 1",
    "/tf_static 2",
    "/tf_static 3",
    "/scan 4999",
  ]);
  expect(history.start).toBe(4999);
  expect(history.end).toBe(4999);
});

it("a message that is replaced later goes later", async () => {
  const history = filled(2500, ["/map", 1], ["/scan", 2], ["/scan", 3], ["/scan", 4]);
  expect(await before(history, { "/map": 9, "/scan": 9 }, 9)).toEqual([
    "/map 1",
    "/scan 3",
    "/scan 4",
  ]);
  expect(history.start).toBe(3);
});

it("a clock that goes back does not change the order", async () => {
  const history = filled(1e6, ["/a", 5], ["/b", 4], ["/a", 6]);
  expect(await after(history, ["/a", "/b"], 0)).toEqual(["/a 5", "/b 5", "/a 6"]);
});
