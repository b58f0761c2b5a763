import { expect, it } from "vitest";
import { recording } from "./recording.fixture";
import { StateTrack } from "./state_track";

const def = (type: string, fields: Record<string, string>, constants: Record<string, string>) => ({
  type,
  fieldnames: Object.keys(fields),
  fieldtypes: Object.values(fields),
  fieldarraylen: Object.keys(fields).map(() => -1),
  examples: [],
  constnames: Object.keys(constants),
  constvalues: Object.values(constants),
});

const GOAL = [
  def("x/Result", { status: "x/Status" }, {}),
  def("x/Status", { status: "uint8", text: "string" }, { PENDING: "0", ACTIVE: "1" }),
];
const BATTERY = [
  def(
    "x/Battery",
    { power_status: "uint8", power_health: "uint8" },
    { POWER_STATUS_FULL: "4", POWER_HEALTH_GOOD: "1", POWER_HEALTH_COLD: "4" },
  ),
];

it("has the changes of a field, and no state twice in a row", () => {
  const track = new StateTrack("ok");
  const record = recording(track);
  for (const [time, ok] of [true, true, false, false, true].entries()) record({ ok }, time);
  expect(track.changes).toEqual([
    { time: 0, state: "true" },
    { time: 2, state: "false" },
    { time: 4, state: "true" },
  ]);
  expect([...track.states.keys()]).toEqual(["true", "false"]);
  expect([-1, 0, 1.9, 2, 9].map((time) => track.at(time))).toEqual([
    undefined,
    "true",
    "true",
    "false",
    "true",
  ]);
});

it("calls integers by the names of their constants", () => {
  const track = new StateTrack("status.status", GOAL);
  const record = recording(track);
  for (const [time, status] of [0, 1n, 7].entries()) record({ status: { status } }, time);
  expect(track.changes.map(({ state }) => state)).toEqual(["PENDING", "ACTIVE", "7"]);
});

it("takes the constants that begin with the field's name, where there are such", () => {
  const status = new StateTrack("power_status", BATTERY);
  const health = new StateTrack("power_health", BATTERY);
  recording(health)({ power_health: 4 }, 0);
  const record = recording(status);
  record({ power_status: 4 }, 0);
  record({ power_status: 1 }, 1);
  expect([status.at(0), health.at(0), status.newest]).toEqual(["FULL", "COLD", "1"]);
});

it("has texts and other numbers, and a time without messages", () => {
  const track = new StateTrack("data");
  const record = recording(track);
  record({ data: "a" }, 1);
  track.pause(2);
  record({ data: -0 }, 3);
  record({ data: { secs: 1, nsecs: 500_000_000 } }, 4);
  expect(record({}, 5)).toBe(true);
  expect(track.changes.map(({ state }) => state)).toEqual([
    "a",
    undefined,
    "-0",
    "1.5 s",
    undefined,
  ]);
});

it("follows an element by its name", () => {
  const track = new StateTrack("list[0].on");
  const record = recording(track);
  record(
    {
      list: [
        { name: "left", on: true },
        { name: "right", on: false },
      ],
    },
    0,
  );
  expect(track.path).toBe("list[left].on");
  record({ list: [{ name: "right", on: false }] }, 1);
  expect(track.newest).toBe("true");
});

it("keeps the newest changes only", () => {
  const track = new StateTrack("x");
  const record = recording(track);
  for (let at = 0; at < 25_000; at += 1) record({ x: at % 2 }, at);
  expect(track.changes.length).toBeLessThanOrEqual(20_000);
  expect(track.changes.at(-1)?.time).toBe(24_999);
  expect(track.states.size).toBe(2);
});
