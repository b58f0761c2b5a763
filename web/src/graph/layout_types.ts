/** The request for a layout, and its result. */

export interface Point {
  x: number;
  y: number;
}

/** Centre and size. */
export interface Box extends Point {
  width: number;
  height: number;
}

/** What is to be laid out. All lengths are in pixels at a zoom of 1. */
export interface LayoutRequest {
  boxes: { id: string; width: number; height: number; group: string | null }[];
  /** With the size of its label. */
  links: { id: string; from: string; to: string; width: number; height: number }[];
  /** With the width of its title; parents come before their children. */
  groups: { name: string; parent: string | null; width: number }[];
  /** The aspect ratio of the viewport. */
  aspect: number;
  /** Layers from top to bottom, for narrow screens, instead of from left to right. */
  down: boolean;
}

/** The path of an edge from border to border, and the position of its label. */
export interface EdgePath {
  points: Point[];
  label: Point;
}

/** The upper left corner and the size of the whole layout. */
export interface Bounds {
  left: number;
  top: number;
  width: number;
  height: number;
}

export interface Layout {
  boxes: Map<string, Box>;
  links: Map<string, EdgePath>;
  groups: Map<string, Box>;
  bounds: Bounds;
}

/** The smallest box around some boxes; null without boxes. */
export function around(boxes: Iterable<Box>): Box | null {
  let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { x, y, width, height } of boxes) {
    left = Math.min(left, x - width / 2);
    right = Math.max(right, x + width / 2);
    top = Math.min(top, y - height / 2);
    bottom = Math.max(bottom, y + height / 2);
  }
  if (left > right) return null;
  return {
    x: (left + right) / 2,
    y: (top + bottom) / 2,
    width: right - left,
    height: bottom - top,
  };
}

/** A layout moved as a whole. */
export function moved(layout: Layout, dx: number, dy: number): Layout {
  const shift = <T extends Point>(at: T): T => ({ ...at, x: at.x + dx, y: at.y + dy });
  return {
    boxes: new Map([...layout.boxes].map(([id, box]) => [id, shift(box)])),
    links: new Map(
      [...layout.links].map(([id, { points, label }]) => [
        id,
        { points: points.map(shift), label: shift(label) },
      ]),
    ),
    groups: new Map([...layout.groups].map(([name, box]) => [name, shift(box)])),
    bounds: {
      ...layout.bounds,
      left: layout.bounds.left + dx,
      top: layout.bounds.top + dy,
    },
  };
}
