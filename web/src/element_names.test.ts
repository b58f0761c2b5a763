import { describe, expect, it, test } from "vitest";
import { elementNames, expand, resolve } from "./element_names";
import { parsePath, pathText } from "./types";

/** The path with names, and with the indices of a message. */
function resolved(message: unknown, path: string): [named: string, indices: string] | undefined {
  const found = resolve(message, parsePath(path) ?? []);
  return found && [pathText(found.named), pathText(found.indices)];
}

const JOINTS = { name: ["shoulder", "elbow"], position: [0.5, 1.5], effort: [] };
const TRAJECTORY = {
  joint_names: ["shoulder", "elbow"],
  points: [{ positions: [1, 2] }, { positions: [3, 4] }],
};
const DIAGNOSTICS = {
  status: [{ name: "/cpu: load", level: 0, values: [{ key: "temp. (C)", value: "40" }] }],
};

describe("elements of arrays have", () => {
  it.each([
    ["position[1]", JOINTS, "position[elbow]"],
    ["effort[1]", JOINTS, "effort[1]"],
    ["points[1].positions[0]", TRAJECTORY, "points[1].positions[shoulder]"],
    ["status[0].level", DIAGNOSTICS, "status[/cpu: load].level"],
    ["status[0].values[0].value", DIAGNOSTICS, "status[/cpu: load].values[temp. (C)].value"],
    [
      "transforms[0].x",
      { transforms: [{ child_frame_id: "base_link" }] },
      "transforms[base_link].x",
    ],
    ["pose[0].position.x", { name: ["car"], pose: [{}], twist: [{}] }, "pose[car].position.x"],
    ["ranges[3]", { ranges: [1, 2, 3, 4] }, "ranges[3]"],
  ])("the name that a message gives them: %s", (path, message, named) => {
    expect(resolved(message, path)).toEqual([named, path]);
    expect(resolved(message, named)).toEqual([named, path]);
  });
});

test("a name is found wherever its element is, or not at all", () => {
  expect(resolved({ name: ["elbow"], position: [2] }, "position[elbow]")?.[1]).toBe("position[0]");
  expect(resolved({ name: ["wrist"], position: [2] }, "position[elbow]")).toBeUndefined();
  expect(resolved({}, "position[elbow]")).toBeUndefined();
});

test("names that are ambiguous or numbers are left out", () => {
  const names = ["a", "a", "7", "b]", "", "c"];
  expect(elementNames([1, 2, 3, 4, 5, 6], "position", [{ name: names }])).toEqual([
    ...[undefined, undefined, undefined, undefined, undefined],
    "c",
  ]);
});

test("a path of the first element stands for all named ones", () => {
  expect(expand(JOINTS, "position[0]")).toEqual(["position[shoulder]", "position[elbow]"]);
  expect(expand(JOINTS, "effort[0]")).toEqual(["effort[0]"]);
  expect(expand(TRAJECTORY, "points[0].positions[0]")).toEqual([
    "points[0].positions[shoulder]",
    "points[0].positions[elbow]",
  ]);
  expect(
    expand(
      { status: [{ name: "a", values: [{ key: "k" }, { key: "l" }] }] },
      "status[0].values[0].x",
    ),
  ).toEqual(["status[a].values[k].x", "status[a].values[l].x"]);
});
