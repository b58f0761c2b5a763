import { describe, expect, it } from "vitest";

import { components, LayoutEngine } from "./layout";
import type { Box, LayoutRequest } from "./layout_types";

const box = (id: string, group: string | null = null) => ({ id, width: 80, height: 40, group });
const link = (from: string, to: string) => ({
  id: `${from}>${to}`,
  from,
  to,
  width: 40,
  height: 15,
});

function request(
  names: string[],
  pairs: [string, string][],
  more: Partial<LayoutRequest> = {},
): LayoutRequest {
  return {
    boxes: names.map((name) => box(name)),
    links: pairs.map(([from, to]) => link(from, to)),
    groups: [],
    canvas: { width: 1280, height: 720 },
    ...more,
  };
}

const at = (layout: { boxes: Map<string, Box> }, id: string): Box => layout.boxes.get(id) as Box;

function overlap(a: Box, b: Box): boolean {
  return (
    Math.abs(a.x - b.x) < (a.width + b.width) / 2 && Math.abs(a.y - b.y) < (a.height + b.height) / 2
  );
}

describe("a layout", () => {
  it("goes from left to right along the edges, or from top to bottom", () => {
    const chain = request(
      ["a", "b", "c"],
      [
        ["a", "b"],
        ["b", "c"],
      ],
    );
    const across = new LayoutEngine().layOut(chain);
    expect(at(across, "a").x).toBeLessThan(at(across, "b").x);
    expect(at(across, "b").x).toBeLessThan(at(across, "c").x);
    const down = new LayoutEngine().layOut({ ...chain, canvas: { width: 390, height: 700 } });
    expect(at(down, "a").y).toBeLessThan(at(down, "b").y);
    expect(at(down, "b").y).toBeLessThan(at(down, "c").y);
  });

  it("has no overlapping boxes, and all within its bounds", () => {
    const names = [..."abcdefghijkl"];
    const pairs = names.map((name, index): [string, string] => [
      name,
      names[(index * 5 + 3) % 12] ?? "a",
    ]);
    const layout = new LayoutEngine().layOut(request(names, pairs));
    const boxes = [...layout.boxes.values()];
    for (const [index, one] of boxes.entries()) {
      for (const other of boxes.slice(index + 1)) expect(overlap(one, other)).toBe(false);
      expect(one.x - one.width / 2).toBeGreaterThanOrEqual(-0.01);
      expect(one.x + one.width / 2).toBeLessThanOrEqual(layout.bounds.width + 0.01);
      expect(one.y + one.height / 2).toBeLessThanOrEqual(layout.bounds.height + 0.01);
    }
  });

  it("has edges from border to border", () => {
    const layout = new LayoutEngine().layOut(request(["a", "b"], [["a", "b"]]));
    const { points } = layout.links.get("a>b") ?? { points: [] };
    expect(points[0]).toEqual({ x: at(layout, "a").x + 40, y: at(layout, "a").y });
    expect(points.at(-1)).toEqual({ x: at(layout, "b").x - 40, y: at(layout, "b").y });
  });

  it("has paths for cycles, parallel edges and loops", () => {
    const layout = new LayoutEngine().layOut(
      request(
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
    for (const { points } of layout.links.values()) {
      expect(points.length).toBeGreaterThan(1);
      for (const { x, y } of points) expect(Number.isFinite(x) && Number.isFinite(y)).toBe(true);
    }
  });

  it("has namespaces around their members only", () => {
    const layout = new LayoutEngine().layOut({
      ...request(
        [],
        [
          ["a", "b"],
          ["b", "c"],
        ],
      ),
      boxes: [box("a", "/r"), box("b", "/r"), box("c"), box("d")],
      groups: [{ name: "/r", parent: null, width: 20 }],
    });
    const around = layout.groups.get("/r") as Box;
    expect(["a", "b", "c", "d"].map((id) => overlap(around, at(layout, id)))).toEqual([
      true,
      true,
      false,
      false,
    ]);
  });

  it("keeps components when an unrelated box is added", () => {
    const engine = new LayoutEngine();
    const before = engine.layOut(
      request(
        ["a", "b", "x", "y"],
        [
          ["a", "b"],
          ["x", "y"],
        ],
      ),
    );
    const after = engine.layOut(
      request(
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

  it("has a row for a namespace's name above its members", () => {
    const layout = new LayoutEngine().layOut({
      ...request([], [["a", "b"]]),
      boxes: [box("a", "/r"), box("b", "/r/s"), box("c", "/r/s")],
      groups: [
        { name: "/r", parent: null, width: 20 },
        { name: "/r/s", parent: "/r", width: 20 },
      ],
    });
    const top = ({ y, height }: Box): number => y - height / 2;
    const [outer, inner] = ["/r", "/r/s"].map((name) => layout.groups.get(name) as Box) as [
      Box,
      Box,
    ];
    expect(top(inner) - top(outer)).toBeGreaterThanOrEqual(20);
    for (const id of ["a", "b", "c"])
      expect(top(at(layout, id)) - top(outer)).toBeGreaterThanOrEqual(20);
    for (const id of ["b", "c"])
      expect(top(at(layout, id)) - top(inner)).toBeGreaterThanOrEqual(20);
  });

  it("turns if names are readable only in the other direction, and stays so", () => {
    const chain = (count: number) => {
      const names = Array.from({ length: count }, (_, index) => `${index}`);
      return request(
        names,
        names.slice(1).map((name, index): [string, string] => [`${index}`, name]),
        { canvas: { width: 700, height: 850 } },
      );
    };
    const engine = new LayoutEngine();
    expect(engine.layOut(chain(3)).down).toBe(false);
    expect(engine.layOut(chain(8)).down).toBe(true);
    expect(engine.layOut(chain(7)).down).toBe(true);
    // As a whole, this is readable in neither direction.
    expect(engine.layOut(chain(100)).down).toBe(false);
  });

  it("fills the canvas with many namespaces that share a topic", () => {
    const spaces = Array.from({ length: 12 }, (_, index) => `/robot${index}`);
    const large: LayoutRequest = {
      boxes: [
        box("/tf"),
        ...spaces.flatMap((space) =>
          Array.from({ length: 8 }, (_, index) => box(`${space}/${index}`, space)),
        ),
      ],
      links: spaces.flatMap((space) => [
        ...Array.from({ length: 7 }, (_, index) => link(`${space}/0`, `${space}/${index + 1}`)),
        link(`${space}/1`, "/tf"),
      ]),
      groups: spaces.map((name) => ({ name, parent: null, width: 60 })),
      canvas: { width: 1280, height: 720 },
    };
    const layout = new LayoutEngine().layOut(large);
    const { width, height } = layout.bounds;
    expect(width / height).toBeGreaterThan(1);
    expect(width / height).toBeLessThan(3.2);
    expect([...layout.links.keys()].sort()).toEqual(large.links.map(({ id }) => id).sort());
    const { points } = layout.links.get("/robot3/1>/tf") ?? { points: [] };
    const tf = at(layout, "/tf");
    expect(Math.abs((points.at(-1)?.x ?? 0) - tf.x)).toBeCloseTo(tf.width / 2);
  });

  it("is deterministic", () => {
    const twice = request(
      ["a", "b", "c"],
      [
        ["a", "b"],
        ["a", "c"],
      ],
    );
    expect(new LayoutEngine().layOut(twice)).toEqual(
      new LayoutEngine().layOut(structuredClone(twice)),
    );
  });

  it("may be empty", () => {
    expect(new LayoutEngine().layOut(request([], []))).toMatchObject({
      bounds: { width: 0, height: 0 },
    });
  });
});

it("components are connected by edges or namespaces", () => {
  const found = components({
    ...request([], [["a", "b"]]),
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
