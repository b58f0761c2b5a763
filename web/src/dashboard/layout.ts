/**
 * Layouts of the dashboard: trees of panes, where each pane is on the screen, and layouts as files.
 *
 * A layout never changes; what changes it returns another one.
 */
import type { Config } from "../panels/panel";
import { own } from "../types";
import { currentName } from "./view_names";

/** Side by side, or below one another. */
export type Direction = "row" | "col";
export type Side = "left" | "right" | "above" | "below";

export interface Pane {
  /** Identifies it on this page; files have none. */
  readonly id: number;
  /** Its share of the split around it; those of all items are 1 together. */
  readonly size: number;
  /** What it shows, such as `picture`; empty for a pane that asks for it. */
  readonly view: string;
  /** The topic, service or action that it shows; empty for views that need none. */
  readonly name: string;
  readonly config: Config;
}

export interface Split {
  readonly split: Direction;
  readonly size: number;
  /** At least two; none of them is a split in the same direction. */
  readonly items: readonly Layout[];
}

export type Layout = Pane | Split;

/** The version of the file format. */
export const SCHEMA = 1;
export const MAX_PANES = 32;
/** Each split has a pane beside the next one in it, so that no layout of the page is deeper. */
const MAX_DEPTH = MAX_PANES;
/** The longest settings of a pane as JSON, and the longest name, in characters. */
const MAX_CONFIG = 10_000;
const MAX_CONFIG_DEPTH = 20;
const MAX_NAME = 256;
/** The least share that a pane can be dragged to. */
const MIN_SIZE = 0.05;

/** Why something is not a layout. */
export class LayoutError extends Error {}

let lastId = 0;

export function newPane(view = "", name = "", config: Config = {}): Pane {
  lastId += 1;
  return { id: lastId, size: 1, view, name, config };
}

/** Some layouts side by side, or below one another; null if there are none. */
export function joined(split: Direction, all: readonly (Layout | null)[], size = 1): Layout | null {
  const items = all.filter((item) => item !== null);
  const [first] = items;
  if (first === undefined) return null;
  if (items.length === 1) return { ...first, size };
  const total = sum(items.map((item) => item.size));
  const flat = items.flatMap((item) => {
    const share = item.size / total;
    if (!("split" in item) || item.split !== split) return [{ ...item, size: share }];
    return item.items.map((inner) => ({ ...inner, size: inner.size * share }));
  });
  return { split, size, items: flat };
}

/** All panes, in reading order. */
export function panesOf(layout: Layout | null): Pane[] {
  if (layout === null) return [];
  return "split" in layout ? layout.items.flatMap(panesOf) : [layout];
}

/** A layout with another one in the place of each pane, or with none. */
export function mapPanes(
  layout: Layout | null,
  change: (pane: Pane) => Layout | null,
): Layout | null {
  if (layout === null) return null;
  if (!("split" in layout)) {
    const changed = change(layout);
    return changed && { ...changed, size: layout.size };
  }
  const items = layout.items.map((item) => mapPanes(item, change));
  return joined(layout.split, items, layout.size);
}

export function remove(layout: Layout | null, id: number): Layout | null {
  return mapPanes(layout, (pane) => (pane.id === id ? null : pane));
}

/** A layout with a pane at a side of another one, whose place they share. */
export function insert(layout: Layout | null, at: number, side: Side, pane: Pane): Layout | null {
  const direction = side === "left" || side === "right" ? "row" : "col";
  const isFirst = side === "left" || side === "above";
  return mapPanes(layout, (each) => {
    if (each.id !== at) return each;
    const pair = [
      { ...each, size: 0.5 },
      { ...pane, size: 0.5 },
    ];
    return joined(direction, isFirst ? pair.reverse() : pair);
  });
}

/** A layout with a pane moved to a side of another one. */
export function move(layout: Layout | null, id: number, at: number, side: Side): Layout | null {
  const pane = panesOf(layout).find((each) => each.id === id);
  if (pane === undefined || id === at) return layout;
  return insert(remove(layout, id), at, side, pane);
}

/** A layout with one more pane, in a half of the largest. */
export function add(layout: Layout | null, pane: Pane): Layout {
  let largest: Place | undefined;
  for (const place of placesOf(layout).panes) {
    if (largest === undefined || place.width * place.height > largest.width * largest.height)
      largest = place;
  }
  if (largest === undefined) return pane;
  // Screens are wider than high.
  const side = largest.width * 1.5 > largest.height ? "right" : "below";
  return insert(layout, largest.pane.id, side, pane) ?? pane;
}

/** A bar between two items of a split, which is found by the positions of the splits around it. */
export interface Bar {
  readonly path: readonly number[];
  /** The position of the item before it. */
  readonly at: number;
  readonly direction: Direction;
  /** Parts of the whole, as of places: `length` is along the bar, `room` what both items have. */
  readonly x: number;
  readonly y: number;
  readonly length: number;
  readonly room: number;
  /** The share of the item before it in that. */
  readonly share: number;
}

/** Where a pane is: parts of the width and of the height of the whole. */
export interface Place {
  readonly pane: Pane;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** Where all panes are, and the bars between them. */
export function placesOf(layout: Layout | null): { panes: Place[]; bars: Bar[] } {
  const panes: Place[] = [];
  const bars: Bar[] = [];
  const put = (
    item: Layout,
    path: readonly number[],
    [x, y, width, height]: readonly [number, number, number, number],
  ): void => {
    if (!("split" in item)) {
      panes.push({ pane: item, x, y, width, height });
      return;
    }
    const { split: direction, items } = item;
    const isRow = direction === "row";
    let [left, top] = [x, y];
    items.forEach((inner, at) => {
      const before = items[at - 1];
      if (before !== undefined) {
        bars.push({
          path,
          at: at - 1,
          direction,
          x: left,
          y: top,
          length: isRow ? height : width,
          room: (isRow ? width : height) * (before.size + inner.size),
          share: before.size / (before.size + inner.size),
        });
      }
      const [w, h] = isRow ? [width * inner.size, height] : [width, height * inner.size];
      put(inner, [...path, at], [left, top, w, h]);
      if (isRow) left += w;
      else top += h;
    });
  };
  if (layout !== null) put(layout, [], [0, 0, 1, 1]);
  return { panes, bars };
}

/** A layout in which the item before a bar has another share of the two beside it, 0 to 1. */
export function resize(
  layout: Layout,
  { path, at }: Pick<Bar, "path" | "at">,
  share: number,
): Layout {
  if (!("split" in layout)) return layout;
  const [first, ...rest] = path;
  if (first !== undefined) {
    const items = layout.items.map((item, index) =>
      index === first ? resize(item, { path: rest, at }, share) : item,
    );
    return { ...layout, items };
  }
  const [before, after] = [layout.items[at], layout.items[at + 1]];
  if (before === undefined || after === undefined) return layout;
  const both = before.size + after.size;
  const least = Math.min(MIN_SIZE, both / 2);
  const size = Math.min(both - least, Math.max(least, both * share));
  const items = layout.items.with(at, { ...before, size });
  return { ...layout, items: items.with(at + 1, { ...after, size: both - size }) };
}

/** Whether two layouts have the same file. */
export function isSame(one: Layout | null, other: Layout | null): boolean {
  return JSON.stringify(plain(one)) === JSON.stringify(plain(other));
}

/** A layout as the text of a file. */
export function toFile(name: string, layout: Layout | null): string {
  return JSON.stringify({ schema: SCHEMA, name, layout: plain(layout) });
}

/**
 * The layout in a file, and its name.
 *
 * Throws a `LayoutError` with the reason if it has none. Views that are unknown, and settings that a
 * panel cannot read, are no error: they may be those of another version.
 */
export function fromFile(text: string): { name: string; layout: Layout | null } {
  let file: unknown;
  try {
    file = JSON.parse(text);
  } catch (error) {
    throw new LayoutError(`Invalid JSON: ${(error as Error).message}`);
  }
  const schema = own(file, "schema");
  if (typeof schema !== "number") {
    throw new LayoutError("Not a layout of the dashboard: expected an object with a “schema”");
  }
  if (schema !== SCHEMA) {
    throw new LayoutError(
      `Unknown schema ${schema}: this page reads ${SCHEMA}, so a hub of another version wrote the file`,
    );
  }
  const name = own(file, "name");
  return { name: typeof name === "string" ? name : "", layout: read(own(file, "layout")) };
}

function plain(layout: Layout | null, size = 1): unknown {
  if (layout === null) return null;
  if (!("split" in layout)) {
    const { view, name, config } = layout;
    return { view, name, size, config };
  }
  const { split, items } = layout;
  const sizes = items.map((item) => rounded(item.size));
  // Exactly 1 together: a layout that is read from a file has the same file again.
  const last = rounded(1 - sum(sizes.slice(0, -1)));
  return {
    split,
    size,
    items: items.map((item, at) => plain(item, sizes[at + 1] === undefined ? last : sizes[at])),
  };
}

function rounded(size: number): number {
  return Number(size.toFixed(4));
}

function sum(sizes: readonly number[]): number {
  return sizes.reduce((total, size) => total + size, 0);
}

function read(value: unknown): Layout | null {
  let count = 0;
  const readItem = (item: unknown, where: string, depth: number): Layout => {
    const fail = (problem: string): never => {
      throw new LayoutError(`Invalid layout: ${where} ${problem}`);
    };
    if (depth > MAX_DEPTH) fail(`is nested deeper than ${MAX_DEPTH}`);
    const [split, view] = [own(item, "split"), own(item, "view")];
    const given = Number(own(item, "size"));
    const size = given > 0 && given < 1e6 ? given : 1;
    if (split === undefined) {
      if (typeof view !== "string" || view.length > MAX_NAME) {
        return fail("must have a “view” or a “split”");
      }
      count += 1;
      if (count > MAX_PANES) fail(`is one too many: the limit is ${MAX_PANES} panels`);
      const [name, config] = [own(item, "name") ?? "", own(item, "config") ?? {}];
      if (typeof name !== "string" || name.length > MAX_NAME) {
        return fail(`must have a “name” of at most ${MAX_NAME} characters`);
      }
      if (typeof config !== "object" || Array.isArray(config)) {
        return fail("must have an object as “config”");
      }
      if (!isShallow(config, MAX_CONFIG_DEPTH)) {
        fail(`has a “config” that is nested deeper than ${MAX_CONFIG_DEPTH}`);
      }
      if (JSON.stringify(config).length > MAX_CONFIG) {
        fail(`has more than ${MAX_CONFIG} characters of “config”`);
      }
      return { ...newPane(currentName(view), name, config as Config), size };
    }
    if (split !== "row" && split !== "col") return fail("must have “row” or “col” as “split”");
    const items = own(item, "items");
    if (!Array.isArray(items) || items.length === 0) return fail("must have a list of “items”");
    if (items.length > MAX_PANES) fail(`has more than ${MAX_PANES} items`);
    const all = items.map((inner, at) => readItem(inner, `${where}.items[${at}]`, depth + 1));
    return joined(split, all, size) ?? fail("is empty");
  };
  return value === null ? null : { ...readItem(value, "“layout”", 0), size: 1 };
}

/** Whether a JSON value is nested no deeper than some levels. */
function isShallow(value: unknown, depth: number): boolean {
  if (typeof value !== "object" || value === null) return true;
  return depth > 0 && Object.values(value).every((inner) => isShallow(inner, depth - 1));
}
