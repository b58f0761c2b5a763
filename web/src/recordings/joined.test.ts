import { expect, it } from "vitest";
import { History } from "../messages/history";
import type { Kept } from "../messages/store";
import { filesOf, JoinedRecording } from "./joined";

/** A part with messages `[topic, time]`. */
function part(...messages: readonly (readonly [string, number])[]) {
  const history = new History(Infinity);
  for (const [topic, time] of messages)
    history.add({ topic, type: "t/T", time, size: 1, node: "", read: () => ({}) });
  const names = [...new Set(messages.map(([topic]) => topic))];
  const topics = names.map((name) => ({ name, type: "t/T", definition: "" }));
  return Object.assign(history, { topics, warnings: ["odd"] });
}

const RECORDING = new JoinedRecording(
  [
    part(["/a", 20], ["/b", 21], ["/a", 29]),
    part(["/map", 1], ["/a", 2], ["/tf_static", 3], ["/a", 9]),
    part(["/a", 10], ["/tf_static", 11], ["/a", 22]),
  ],
  ["one file is missing"],
);

function text(found: readonly Kept[]): string[] {
  return found.map(({ topic, time }) => `${topic} ${time}`);
}

async function before(wanted: Record<string, [count: number, span: number]>, time: number) {
  const wishes = Object.entries(wanted).map(
    ([topic, [count, span]]) => [topic, { count, span }] as const,
  );
  return text(await RECORDING.before(new Map(wishes), time));
}

it("has the topics, times and warnings of all parts", () => {
  expect(RECORDING.topics.map(({ name }) => name)).toEqual(["/a", "/b", "/map", "/tf_static"]);
  expect([RECORDING.start, RECORDING.end]).toEqual([1, 29]);
  expect(RECORDING.warnings).toEqual(["one file is missing", "odd"]);
});

it("finds what came last in the part that has it", async () => {
  expect(await before({ "/map": [1, 0], "/b": [1, 0] }, 28)).toEqual(["/map 1", "/b 21"]);
  expect(await before({ "/b": [1, 0] }, 20)).toEqual([]);
  expect(await before({ "/tf_static": [Infinity, 0] }, 28)).toEqual([
    "/tf_static 3",
    "/tf_static 11",
  ]);
  expect(await before({ "/a": [9, 25] }, 28)).toEqual(["/a 2", "/a 9", "/a 10", "/a 20", "/a 22"]);
});

it("plays parts in the order of time, also where they overlap", async () => {
  const found: Kept[] = [];
  for await (const kept of RECORDING.after(new Set(["/a", "/b"]), 2)) found.push(kept);
  expect(text(found)).toEqual(["/a 9", "/a 10", "/a 20", "/b 21", "/a 22", "/a 29"]);
});

it("reads the files of a folder's metadata", () => {
  const metadata = `rosbag2_bagfile_information:
  version: 5
  relative_file_paths:
    - run_0.mcap
    - "run_1.mcap"
  duration: {nanoseconds: 1}
`;
  expect(filesOf(metadata)).toEqual(["run_0.mcap", "run_1.mcap"]);
  expect(filesOf("nothing: 1")).toEqual([]);
});
