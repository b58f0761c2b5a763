// What is asked of a layout, and its answer.

export interface Point {
  x: number;
  y: number;
}

/** Middle and size. */
export interface Box extends Point {
  width: number;
  height: number;
}

/** What is to be placed. All lengths are in pixels at a zoom of 1. */
export interface Plan {
  boxes: { id: string; width: number; height: number; group: string | null }[];
  /** With the room that the words on it need. */
  links: { id: string; from: string; to: string; width: number; height: number }[];
  /** With the width of its title; a parent comes before its children. */
  groups: { name: string; parent: string | null; width: number }[];
  /** Width by height of where it will be looked at. */
  aspect: number;
  /** Layers from the top down, as narrow screens want them, and not from left to right. */
  down: boolean;
}

/** An arrow's way: its bends from border to border, and where its words are. */
export interface Way {
  points: Point[];
  label: Point;
}

/** The upper left corner and the size of everything. */
export interface Bounds {
  left: number;
  top: number;
  width: number;
  height: number;
}

export interface Places {
  boxes: Map<string, Box>;
  links: Map<string, Way>;
  groups: Map<string, Box>;
  bounds: Bounds;
}

/** The smallest box around all of these; null around none. */
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

/** The same, all of it moved by so much. */
export function moved(places: Places, dx: number, dy: number): Places {
  const shift = <T extends Point>(at: T): T => ({ ...at, x: at.x + dx, y: at.y + dy });
  return {
    boxes: new Map([...places.boxes].map(([id, box]) => [id, shift(box)])),
    links: new Map(
      [...places.links].map(([id, { points, label }]) => [
        id,
        { points: points.map(shift), label: shift(label) },
      ]),
    ),
    groups: new Map([...places.groups].map(([name, box]) => [name, shift(box)])),
    bounds: {
      ...places.bounds,
      left: places.bounds.left + dx,
      top: places.bounds.top + dy,
    },
  };
}
