import { expect, test } from "vitest";

import {
  add,
  fromFile,
  insert,
  isSame,
  joined,
  type Layout,
  LayoutError,
  MAX_PANES,
  move,
  newPane,
  panesOf,
  placesOf,
  remove,
  resize,
  type Side,
  toFile,
} from "./layout";

/** Numbers from 0 to 1 that are the same in every run. */
function numbers(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 1_664_525 + 1_013_904_223) % 4_294_967_296;
    return state / 4_294_967_296;
  };
}

/** The views of a layout as text: `row(a, col(b, c))`. */
function text(layout: Layout | null): string {
  if (layout === null) return "nothing";
  if (!("split" in layout)) return layout.view;
  return `${layout.split}(${layout.items.map(text).join(", ")})`;
}

function sizes(layout: Layout | null): number[] {
  return layout !== null && "split" in layout ? layout.items.map(({ size }) => size) : [];
}

const [a, b, c, d] = ["a", "b", "c", "d"].map((view) => newPane(view)) as [
  ReturnType<typeof newPane>,
  ReturnType<typeof newPane>,
  ReturnType<typeof newPane>,
  ReturnType<typeof newPane>,
];

/** Check what holds for every layout: shares, depth of splits, and places that fill the whole. */
function check(layout: Layout | null): void {
  const visit = (item: Layout, around: string): void => {
    if (!("split" in item)) return;
    expect(item.items.length).toBeGreaterThan(1);
    expect(item.split).not.toBe(around);
    expect(sizes(item).reduce((one, other) => one + other)).toBeCloseTo(1, 9);
    for (const inner of item.items) visit(inner, item.split);
  };
  if (layout === null) return;
  visit(layout, "");
  const { panes, bars } = placesOf(layout);
  const area = panes.reduce((sum, { width, height }) => sum + width * height, 0);
  expect(area).toBeCloseTo(1, 6);
  expect(bars.length).toBe(panes.length - 1);
  expect(new Set(panes.map(({ pane }) => pane.id)).size).toBe(panes.length);
}

test("a pane is split at each of its sides", () => {
  const sides: [Side, string][] = [
    ["right", "row(a, b)"],
    ["left", "row(b, a)"],
    ["below", "col(a, b)"],
    ["above", "col(b, a)"],
  ];
  for (const [side, expected] of sides) expect(text(insert(a, a.id, side, b))).toBe(expected);
});

test("a split in the same direction joins the one around it", () => {
  const two = insert(a, a.id, "right", b);
  const three = insert(two, b.id, "right", c);
  expect(text(three)).toBe("row(a, b, c)");
  expect(sizes(three)).toEqual([0.5, 0.25, 0.25]);
  expect(text(insert(three, b.id, "below", d))).toBe("row(a, col(b, d), c)");
});

test("the others share the place of a removed pane", () => {
  const layout = joined("row", [a, joined("col", [b, c]), d]);
  expect(text(remove(layout, b.id))).toBe("row(a, c, d)");
  expect(sizes(remove(layout, a.id))).toEqual([0.5, 0.5]);
  expect(text(remove(joined("row", [a, joined("col", [b, c])]), a.id))).toBe("col(b, c)");
  expect(remove(a, a.id)).toBeNull();
});

test("a pane is moved beside another one, and not beside itself", () => {
  const layout = joined("row", [a, joined("col", [b, c])]);
  expect(text(move(layout, a.id, c.id, "below"))).toBe("col(b, c, a)");
  expect(text(move(layout, c.id, a.id, "left"))).toBe("row(c, a, b)");
  expect(move(layout, a.id, a.id, "left")).toBe(layout);
});

test("a new pane takes half of the largest", () => {
  expect(text(add(null, a))).toBe("a");
  expect(text(add(a, b))).toBe("row(a, b)");
  const layout = joined("row", [a, { ...b, size: 3 }]);
  expect(text(add(layout, c))).toBe("row(a, b, c)");
});

test("a bar moves only what is beside it, and leaves a rest of both", () => {
  const layout = joined("row", [a, b, joined("col", [c, d])]) as Layout;
  const [, second, third] = placesOf(layout).bars;
  const moved = resize(layout, second as never, 0.75);
  expect(sizes(moved)[0]).toBeCloseTo(1 / 3);
  expect(sizes(moved)[1]).toBeCloseTo(0.5);
  const down = resize(moved, third as never, -5);
  expect(placesOf(down).panes[2]?.height).toBeCloseTo(0.05);
  check(down);
});

test("places and bars are parts of the whole", () => {
  const layout = joined("row", [a, { ...(joined("col", [b, c]) as Layout), size: 3 }]);
  const { panes, bars } = placesOf(layout);
  expect(panes.map(({ x, y, width, height }) => [x, y, width, height])).toEqual([
    [0, 0, 0.25, 1],
    [0.25, 0, 0.75, 0.5],
    [0.25, 0.5, 0.75, 0.5],
  ]);
  expect(bars).toMatchObject([
    { direction: "row", x: 0.25, y: 0, length: 1, room: 1, share: 0.25 },
    { direction: "col", x: 0.25, y: 0.5, length: 0.75, room: 1, share: 0.5 },
  ]);
});

test("random changes keep a layout in order, and it is read back from its file", () => {
  const random = numbers(18);
  const sides: Side[] = ["left", "right", "above", "below"];
  const pick = <T>(all: readonly T[]): T => all[Math.floor(random() * all.length)] as T;
  for (let round = 0; round < 12; round += 1) {
    let layout: Layout | null = newPane("first");
    for (let step = 0; step < 60; step += 1) {
      const panes = panesOf(layout);
      const chance = random();
      if (layout === null || chance < 0.1) layout = add(layout, newPane("added"));
      else if (chance < 0.5 && panes.length < MAX_PANES)
        layout = insert(layout, pick(panes).id, pick(sides), newPane("new", "/x", { step }));
      else if (chance < 0.7) layout = remove(layout, pick(panes).id);
      else if (chance < 0.85) layout = move(layout, pick(panes).id, pick(panes).id, pick(sides));
      else {
        const { bars } = placesOf(layout);
        if (bars.length > 0) layout = resize(layout, pick(bars), random() * 2 - 0.5);
      }
      check(layout);
    }
    while (panesOf(layout).length > MAX_PANES)
      layout = remove(layout, panesOf(layout)[0]?.id as number);
    const file = toFile("random", layout);
    const again = fromFile(file);
    check(again.layout);
    expect(again.name).toBe("random");
    expect(isSame(again.layout, layout)).toBe(true);
    expect(toFile("random", again.layout)).toBe(file);
  }
});

test.each([
  ["", "Invalid JSON"],
  ["null", "Not a layout"],
  ["[]", "Not a layout"],
  ['{"layout": null}', "Not a layout"],
  ['{"schema": 2, "layout": null}', "Unknown schema 2"],
  ['{"schema": 1}', "“layout” must have a “view” or a “split”"],
  ['{"schema": 1, "layout": 5}', "“layout” must have a “view” or a “split”"],
  ['{"schema": 1, "layout": {"split": "diagonal", "items": []}}', "“row” or “col”"],
  ['{"schema": 1, "layout": {"split": "row", "items": []}}', "a list of “items”"],
  ['{"schema": 1, "layout": {"split": "row", "items": [{"view": 1}]}}', "“layout”.items[0]"],
  ['{"schema": 1, "layout": {"view": "map", "name": 5}}', "“name”"],
  ['{"schema": 1, "layout": {"view": "map", "config": []}}', "“config”"],
  [
    `{"schema": 1, "layout": {"view": "map", "config": {"x": "${"x".repeat(20_000)}"}}}`,
    "characters of “config”",
  ],
])("the file %j is refused with a reason", (file, reason) => {
  expect(() => fromFile(file)).toThrow(LayoutError);
  expect(() => fromFile(file)).toThrow(reason);
});

test("a layout with too many panels, or too deep a one, is refused", () => {
  const many = { split: "row", items: Array.from({ length: MAX_PANES }, () => ({ view: "a" })) };
  const file = (layout: unknown) => JSON.stringify({ schema: 1, layout });
  expect(panesOf(fromFile(file(many)).layout)).toHaveLength(MAX_PANES);
  expect(() => fromFile(file({ split: "col", items: [many, { view: "b" }] }))).toThrow("too many");
  const nested = (before: string, inner: string, after: string) =>
    `{"schema": 1, "layout": ${before.repeat(50_000)}${inner}${after.repeat(50_000)}}`;
  const deep = nested('{"split": "row", "items": [', '{"view": "a"}', "]}");
  expect(() => fromFile(deep)).toThrow("nested deeper");
  const config = nested('{"view": "a", "config": ', "{}", "}");
  expect(() => fromFile(config)).toThrow("nested deeper");
});

test("strange sizes and unknown views are read, and splits are put in order", () => {
  const file = {
    schema: 1,
    name: 7,
    layout: {
      split: "row",
      items: [
        { view: "of another version", size: -1, config: { __proto__: null, deep: [1, { x: 2 }] } },
        { split: "row", size: "wide", items: [{ view: "a", size: Infinity }, { view: "b" }] },
        { split: "col", items: [{ view: "c", more: true }] },
      ],
    },
  };
  const { name, layout } = fromFile(JSON.stringify(file));
  expect(name).toBe("");
  expect(text(layout)).toBe("row(of another version, a, b, c)");
  check(layout);
});

test("random files are read or refused, and nothing else happens", () => {
  const random = numbers(5);
  const words = [
    "split",
    "view",
    "items",
    "size",
    "name",
    "config",
    "layout",
    "schema",
    "__proto__",
  ];
  const values = ["row", "col", "map", "", null, 0, 1, -1, 1e300, true, [], {}];
  const value = (depth: number): unknown => {
    const chance = random();
    if (depth > 4 || chance < 0.35) return values[Math.floor(random() * values.length)];
    if (chance < 0.55) {
      return Array.from({ length: Math.floor(random() * 5) }, () => value(depth + 1));
    }
    // As often as not, what is expected at that place.
    const object: [string, unknown][] = [];
    for (const word of words) if (random() < 0.4) object.push([word, value(depth + 1)]);
    if (random() < 0.6) {
      object.push(
        random() < 0.5
          ? ["view", "map"]
          : ["items", Array.from({ length: 1 + Math.floor(random() * 3) }, () => value(depth + 1))],
        ["split", random() < 0.5 ? "row" : undefined],
      );
    }
    return Object.fromEntries(object);
  };
  let read = 0;
  for (let round = 0; round < 1000; round += 1) {
    const file = JSON.stringify({ schema: 1, layout: value(0) });
    try {
      check(fromFile(file).layout);
      read += 1;
    } catch (error) {
      if (!(error instanceof LayoutError)) throw error;
    }
  }
  expect(read).toBeGreaterThan(50);
});
