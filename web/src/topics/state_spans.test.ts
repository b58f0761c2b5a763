import { expect, it } from "vitest";
import { recording } from "./recording.fixture";
import { spansOf } from "./state_spans";
import { StateTrack } from "./state_track";

function track(...states: [time: number, state: string | undefined][]): StateTrack {
  const made = new StateTrack("data");
  const record = recording(made);
  for (const [time, data] of states) {
    if (data === undefined) made.pause(time);
    else record({ data }, time);
  }
  return made;
}

it("has the spans that are seen, from edge to edge", () => {
  const spans = spansOf(track([0, "a"], [4, "b"], [6, undefined], [8, "a"]), 2, 12, 100);
  expect(spans).toEqual([
    { left: 0, right: 20, state: "a", colour: 0 },
    { left: 20, right: 40, state: "b", colour: 1 },
    { left: 60, right: 100, state: "a", colour: 0 },
  ]);
  expect(spansOf(track([5, "a"]), 0, 4, 100)).toEqual([]);
  expect(spansOf(track(), 0, 4, 100)).toEqual([]);
});

it("shows the shortest state, too, and as many as there are pixels", () => {
  const spans = spansOf(track([0, "a"], [5.001, "b"], [5.002, "a"]), 0, 10, 100);
  expect(spans.map(({ left, right, state }) => [left, right, state])).toEqual([
    [0, 50, "a"],
    [50, 51, "b"],
    [51, 100, "a"],
  ]);
  const wild = track(
    ...Array.from({ length: 5000 }, (_, at): [number, string] => [at / 500, `${at % 2}`]),
  );
  expect(spansOf(wild, 0, 10, 100).length).toBeLessThanOrEqual(100);
});
