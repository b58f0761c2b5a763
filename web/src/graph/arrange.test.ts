import { describe, expect, it } from "vitest";

import { Arranger, islands } from "./arrange";
import type { Box, Plan } from "./places";

const box = (id: string, group: string | null = null) => ({ id, width: 80, height: 40, group });
const link = (from: string, to: string) => ({
  id: `${from}>${to}`,
  from,
  to,
  width: 40,
  height: 15,
});

function plan(names: string[], pairs: [string, string][], more: Partial<Plan> = {}): Plan {
  return {
    boxes: names.map((name) => box(name)),
    links: pairs.map(([from, to]) => link(from, to)),
    groups: [],
    aspect: 1.6,
    down: false,
    ...more,
  };
}

const at = (places: { boxes: Map<string, Box> }, id: string): Box => places.boxes.get(id) as Box;

function overlap(a: Box, b: Box): boolean {
  return (
    Math.abs(a.x - b.x) < (a.width + b.width) / 2 && Math.abs(a.y - b.y) < (a.height + b.height) / 2
  );
}

describe("an arrangement", () => {
  it("goes from left to right along the arrows, or from the top down", () => {
    const chain = plan(
      ["a", "b", "c"],
      [
        ["a", "b"],
        ["b", "c"],
      ],
    );
    const across = new Arranger().arrange(chain);
    expect(at(across, "a").x).toBeLessThan(at(across, "b").x);
    expect(at(across, "b").x).toBeLessThan(at(across, "c").x);
    const down = new Arranger().arrange({ ...chain, down: true });
    expect(at(down, "a").y).toBeLessThan(at(down, "b").y);
    expect(at(down, "b").y).toBeLessThan(at(down, "c").y);
  });

  it("lets no box lie on another, and all in its bounds", () => {
    const names = [..."abcdefghijkl"];
    const pairs = names.map((name, index): [string, string] => [
      name,
      names[(index * 5 + 3) % 12] ?? "a",
    ]);
    const places = new Arranger().arrange(plan(names, pairs));
    const boxes = [...places.boxes.values()];
    for (const [index, one] of boxes.entries()) {
      for (const other of boxes.slice(index + 1)) expect(overlap(one, other)).toBe(false);
      expect(one.x - one.width / 2).toBeGreaterThanOrEqual(-0.01);
      expect(one.x + one.width / 2).toBeLessThanOrEqual(places.bounds.width + 0.01);
      expect(one.y + one.height / 2).toBeLessThanOrEqual(places.bounds.height + 0.01);
    }
  });

  it("leads each arrow from the border of one box to that of the other", () => {
    const places = new Arranger().arrange(plan(["a", "b"], [["a", "b"]]));
    const { points } = places.links.get("a>b") ?? { points: [] };
    expect(points[0]).toEqual({ x: at(places, "a").x + 40, y: at(places, "a").y });
    expect(points.at(-1)).toEqual({ x: at(places, "b").x - 40, y: at(places, "b").y });
  });

  it("has a place for arrows in a ring, between the same two, and from a box to itself", () => {
    const places = new Arranger().arrange(
      plan(
        ["a", "b", "c"],
        [
          ["a", "b"],
          ["b", "c"],
          ["c", "a"],
          ["b", "a"],
          ["a", "a"],
        ],
      ),
    );
    for (const { points } of places.links.values()) {
      expect(points.length).toBeGreaterThan(1);
      for (const { x, y } of points) expect(Number.isFinite(x) && Number.isFinite(y)).toBe(true);
    }
  });

  it("draws a namespace around those in it, and around nothing else", () => {
    const places = new Arranger().arrange({
      ...plan(
        [],
        [
          ["a", "b"],
          ["b", "c"],
        ],
      ),
      boxes: [box("a", "/r"), box("b", "/r"), box("c"), box("d")],
      groups: [{ name: "/r", parent: null, width: 20 }],
    });
    const around = places.groups.get("/r") as Box;
    expect(["a", "b", "c", "d"].map((id) => overlap(around, at(places, id)))).toEqual([
      true,
      true,
      false,
      false,
    ]);
  });

  it("leaves the others alone when one comes that has nothing to do with them", () => {
    const arranger = new Arranger();
    const before = arranger.arrange(
      plan(
        ["a", "b", "x", "y"],
        [
          ["a", "b"],
          ["x", "y"],
        ],
      ),
    );
    const after = arranger.arrange(
      plan(
        ["a", "b", "n", "x", "y"],
        [
          ["a", "b"],
          ["x", "y"],
        ],
      ),
    );
    const step = (id: string) => at(after, id).x - at(before, id).x;
    expect(step("b")).toBe(step("a"));
    expect(step("y")).toBe(step("x"));
  });

  it("is the same each time", () => {
    const twice = plan(
      ["a", "b", "c"],
      [
        ["a", "b"],
        ["a", "c"],
      ],
    );
    expect(new Arranger().arrange(twice)).toEqual(new Arranger().arrange(structuredClone(twice)));
  });

  it("may be empty", () => {
    expect(new Arranger().arrange(plan([], []))).toMatchObject({ bounds: { width: 0, height: 0 } });
  });
});

it("finds what hangs together by arrows or by namespaces", () => {
  const found = islands({
    ...plan([], [["a", "b"]]),
    boxes: [box("a"), box("b"), box("c", "/r/s"), box("d", "/r"), box("e")],
    groups: [
      { name: "/r", parent: null, width: 20 },
      { name: "/r/s", parent: "/r", width: 20 },
    ],
  });
  expect(found.map(({ boxes }) => boxes.map(({ id }) => id))).toEqual([
    ["a", "b"],
    ["c", "d"],
    ["e"],
  ]);
  expect(found.map(({ links, groups }) => [links.length, groups.length])).toEqual([
    [1, 0],
    [0, 2],
    [0, 0],
  ]);
});
