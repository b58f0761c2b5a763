import { expect, it } from "vitest";

import type { Rates } from "../model";
import type { Edge } from "./picture";
import { linesOf, rateLabel } from "./shapes";

const EDGE: Edge = {
  id: "1",
  from: "topic /t",
  to: "node /n",
  publishers: [],
  subscriptions: ["/t /n"],
  label: "",
  latched: false,
  dashed: false,
  bothWays: false,
  conflict: "",
  direct: false,
  about: "/n subscribes to /t",
};

function rates(messages: number, dropped = 0, total = 0): Rates {
  return {
    topics: new Map(),
    publishers: new Map([["/t /p", { messages, bytes: 10 * messages, dropped: 0 }]]),
    subscriptions: new Map([["/t /n", { messages, bytes: 10 * messages, dropped }]]),
    dropped: new Map([["/t /n", total]]),
  };
}

it.each([
  ["/scan", ["/scan"]],
  ["joint_state_publisher", ["joint_state_", "publisher"]],
  ["camera/color/image_raw", ["camera/color/", "image_raw"]],
  [
    "move_base/global_costmap/costmap_updates",
    ["move_base/", "global_costmap/", "costmap_updates"],
  ],
  ["a".repeat(30), ["a".repeat(30)]],
  ["", [""]],
])("the name %s is broken only after slashes and underscores", (name, lines) => {
  expect(linesOf(name)).toEqual(lines);
});

it("the middle is cut out of a very long name", () => {
  const lines = linesOf(`/${"part_".repeat(40)}end`);
  expect(lines.length).toBeLessThanOrEqual(3);
  expect(lines.join("")).toMatch(/^\/part_.*….*_end$/);
});

it("the label has the rate, the tooltip also the edge", () => {
  const { label, title, idle } = rateLabel(EDGE, rates(1));
  expect([label, title, idle]).toEqual(["1.0 Hz", "/n subscribes to /t: 1.0 Hz, 10 B/s", false]);
});

it("there is no label without messages", () => {
  expect(rateLabel(EDGE, rates(0))).toMatchObject({ label: "", idle: true, drops: false });
});

it("an edge with a conflict is labelled with the other type, whatever passes", () => {
  const { label, title, idle } = rateLabel({ ...EDGE, conflict: "a/B", about: "why" }, rates(5));
  expect([label, title, idle]).toEqual(["⚠ a/B", "why", false]);
});

it("the tooltip says if messages between ROS 1 nodes are missing in the rate", () => {
  expect(rateLabel({ ...EDGE, direct: true }, rates(1)).title).toMatch(/1.0 Hz.*not counted/);
});

it("the line width is logarithmic", () => {
  const width = (messages: number) => rateLabel(EDGE, rates(messages)).stroke;
  expect(width(10)).toBeGreaterThan(width(1));
  expect(width(1000) - width(100)).toBeCloseTo(width(100_000) - width(10_000), 1);
  expect(width(1_000_000)).toBeLessThan(7);
});

it("drops are shown in the label and the tooltip", () => {
  const { label, title, drops } = rateLabel(EDGE, rates(10, 2, 12));
  expect(label).toBe("⚠ 10.0 Hz");
  expect(title).toMatch(/12 dropped .* 2.0 Hz now/);
  expect(drops).toBe(true);
  expect(rateLabel(EDGE, rates(10, 0, 12))).toMatchObject({ drops: false, label: "10.0 Hz" });
});

it("a latched topic is marked", () => {
  const latched: Edge = { ...EDGE, publishers: ["/t /p"], subscriptions: [], latched: true };
  expect(rateLabel(latched, rates(0)).label).toBe("latched");
  expect(rateLabel(latched, rates(2)).label).toBe("2.0 Hz latched");
});

it("the rate of an action is the sum of both directions", () => {
  const both: Edge = { ...EDGE, publishers: ["/t /p"], bothWays: true };
  expect(rateLabel(both, rates(3)).label).toBe("6.0 Hz");
});
