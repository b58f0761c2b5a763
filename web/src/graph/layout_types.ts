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

export interface Size {
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
  /** The size of the canvas, which the layout should fill. */
  canvas: Size;
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
  /** Whether the layers go from top to bottom, not from left to right. */
  down: boolean;
}

/** Small graphs are not enlarged to the size of the canvas. */
const MAX_FIT = 1.2;
/** The least zoom at which names are readable: their 14 px become 10 px. */
export const READABLE = 0.7;
/** The space around a drawing that fits, in pixels; less on a small canvas. */
const MARGIN = 28;
/** A canvas narrower than this is that of a phone, in pixels. */
const NARROW = 560;

export function marginOf(canvas: Size): number {
  return canvas.width < NARROW ? MARGIN / 2 : MARGIN;
}

/** The zoom at which a drawing just fits into a canvas, at most `MAX_FIT`. */
export function zoomToFit(drawing: Size, canvas: Size): number {
  const inner = (length: number): number => Math.max(40, length - 2 * marginOf(canvas));
  return Math.min(
    MAX_FIT,
    inner(canvas.width) / drawing.width,
    inner(canvas.height) / drawing.height,
  );
}

/** Whether layers go from top to bottom on a canvas, if both directions are equally good. */
export function prefersDown({ width, height }: Size): boolean {
  return width < NARROW || width < 0.8 * height;
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
    down: layout.down,
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
