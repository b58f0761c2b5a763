import { beforeEach, describe, expect, it } from "vitest";
import {
  DiagnosticsTree,
  type Item,
  MAX_ITEMS,
  matches,
  pathOf,
  type Status,
  sorted,
} from "./tree";

function status(name: string, level = 0, message = "m"): Status {
  return { name, level, message, hardware_id: "", values: [] };
}

function outline(item: Item): unknown[] {
  return sorted(item).map((child) =>
    child.children.size === 0
      ? `${child.label} ${child.level}`
      : [`${child.label} ${child.level}`, ...outline(child)],
  );
}

let tree: DiagnosticsTree;

beforeEach(() => {
  tree = new DiagnosticsTree();
});

describe("DiagnosticsTree", () => {
  it("has the worst first", () => {
    tree.update(
      [
        status("/robot/Motors/left"),
        status("/robot/Motors/right", 2),
        status("/robot/Motors", 2),
        status("/robot/Sensors/laser", 1),
        status("camera: Temperature"),
        status("alone"),
      ],
      0,
    );
    expect(outline(tree.root)).toEqual([
      ["robot error", ["Motors error", "right error", "left ok"], ["Sensors warn", "laser warn"]],
      "alone ok",
      ["camera ok", "Temperature ok"],
    ]);
    expect(tree.counts).toEqual({ ok: 3, warn: 1, error: 2, stale: 0 });
  });

  it("remembers how levels have changed", () => {
    tree.update([status("a"), status("b", 1, "hot")], 1);
    tree.update([status("a", 2, "gone")], 2);
    tree.update([status("a", 0, "back")], 3);
    expect(tree.changes).toEqual([
      { time: 3, name: "a", from: "error", to: "ok", message: "back" },
      { time: 2, name: "a", from: "ok", to: "error", message: "gone" },
      { time: 1, name: "b", from: "ok", to: "warn", message: "hot" },
    ]);
    for (let time = 4; time < 200; time += 1) tree.update([status("a", time % 2)], time);
    expect(tree.changes.length).toBe(50);
  });

  it("has statuses that are not repeated stale", () => {
    tree.update([status("a"), status("b")], 0);
    tree.update([status("b")], 3000);
    tree.age(6000);
    expect(outline(tree.root)).toEqual(["a stale", "b ok"]);
    tree.update([status("a")], 7000);
    expect(tree.counts.stale).toBe(0);
  });

  it("keeps names that objects have", () => {
    tree.update([status("__proto__/constructor", 2)], 0);
    expect(outline(tree.root)).toEqual([["__proto__ error", "constructor error"]]);
  });

  it("is bounded", () => {
    const many = Array.from({ length: MAX_ITEMS + 5 }, (_, at) => status(`s${at}`));
    tree.update(many, 0);
    expect(tree.root.children.size).toBe(MAX_ITEMS);
    expect(tree.isFull).toBe(true);
  });
});

it.each([
  ["/a/b", ["a", "b"]],
  ["/a", ["a"]],
  ["node: check: x", ["node", "check: x"]],
  ["node/x: y", ["node", "x: y"]],
  ["plain", ["plain"]],
])("pathOf(%s)", (name, path) => {
  expect(pathOf(name)).toEqual(path);
});

it("filters by name and message, also of those below", () => {
  tree.update([status("/robot/Motors/left", 1, "Too hot")], 0);
  const [robot] = sorted(tree.root);
  expect(robot && matches(robot, "hot")).toBe(true);
  expect(robot && matches(robot, "motors")).toBe(true);
  expect(robot && matches(robot, "laser")).toBe(false);
});
