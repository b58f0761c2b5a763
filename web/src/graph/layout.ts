/** Lays out boxes and edges in layers, by dagre. It has no side effects and runs in the worker. */

import { layout as dagreLayout, Graph } from "@dagrejs/dagre";
import { greatest } from "../lists";
import { edgePath, layersOf, spreadLabels } from "./edge_paths";
import {
  around,
  type Box,
  type EdgePath,
  type Layout,
  type LayoutRequest,
  moved,
  type Point,
  prefersDown,
  READABLE,
  type Size,
  zoomToFit,
} from "./layout_types";

/** A part of the request without an edge or namespace in common with the rest. */
type Component = Omit<LayoutRequest, "canvas">;

type Link = LayoutRequest["links"][number];

/** Up to this many boxes get more space between layers. */
const FEW = 8;
/** More boxes than this need the faster algorithm. */
const MANY = 40;
/** As a whole, a graph with more boxes than this takes seconds. */
const VERY_MANY = 200;
/** The largest part of the edges that may go directly from one namespace to another. */
const MAX_CROSSING = 0.3;
const BETWEEN_LAYERS = 26;
const BETWEEN_BOXES = 32;
const BETWEEN_ARROWS = 10;
const BETWEEN_COMPONENTS = 36;
/** The padding of a namespace, and the height of its title. */
const PADDING = 14;
const TITLE = 14;

/** A layout is good enough if names are about as large as in other parts of the page. */
const GOOD = 0.9;
/** The other direction of the layers must show everything this much larger to be chosen. */
const MUCH_LARGER = 1.3;

/** Caches the components of the last layout, since most changes concern only one. */
export class LayoutEngine {
  #cache = new Map<string, Layout>();
  /** The direction that was chosen last, for canvases that prefer that direction or the other. */
  #chosen: { preferred: boolean; down: boolean } | null = null;

  /**
   * Lay out a graph in the direction that suits the canvas.
   *
   * Layers go from left to right on a wide canvas and from top to bottom on a narrow one, unless
   * names become readable only in the other direction. Once chosen, it stays while the graph grows.
   * In a graph that is too large for the canvas, namespaces are laid out one by one if there are few
   * edges between them, and they fill the canvas better.
   */
  layOut(request: LayoutRequest): Layout {
    const cache = new Map<string, Layout>();
    const { canvas } = request;
    const arranged = (parts: readonly Component[], down: boolean): Layout => {
      const layouts = parts.map((component) => {
        const key = JSON.stringify([component, down]);
        const layout = this.#cache.get(key) ?? componentLayout(component, down);
        cache.set(key, layout);
        return layout;
      });
      return pack(layouts, canvas, down);
    };
    const zoomOf = (layout: Layout): number => zoomToFit(layout.bounds, canvas);
    const crossing = linksBetweenNamespaces(request);
    const apart = (down: boolean): Layout => {
      const links = request.links.filter((link) => !crossing.has(link));
      return withLinks(arranged(components({ ...request, links }), down), crossing);
    };
    const areSeparable = crossing.size > 0 && crossing.size < MAX_CROSSING * request.links.length;
    const preferred = prefersDown(canvas);
    const first = this.#chosen?.preferred === preferred ? this.#chosen.down : preferred;
    const mayBeRead = mayBeReadable(request);
    let best: Layout;
    if (!mayBeRead && areSeparable && request.boxes.length > VERY_MANY) best = apart(preferred);
    else {
      const whole = components(request);
      best = arranged(whole, mayBeRead ? first : preferred);
      if (mayBeRead && zoomOf(best) < GOOD) {
        const other = arranged(whole, !first);
        const isBetter = zoomOf(other) > MUCH_LARGER * zoomOf(best);
        // If neither is readable as a whole, the preferred direction is easier to follow.
        const isUseless = zoomOf(best) < READABLE && first !== preferred;
        if (zoomOf(other) >= READABLE ? isBetter : isUseless) best = other;
      }
      if (zoomOf(best) < READABLE && areSeparable) {
        const other = apart(best.down);
        if (zoomOf(other) > MUCH_LARGER * zoomOf(best)) best = other;
      }
    }
    this.#chosen = { preferred, down: best.down };
    this.#cache = cache;
    return best;
  }
}

/** Whether names could be readable if the boxes and the usual space around them fill the canvas. */
function mayBeReadable({ boxes, canvas }: LayoutRequest): boolean {
  const area = boxes.reduce(
    (sum, { width, height }) => sum + (width + BETWEEN_LAYERS) * (height + BETWEEN_BOXES / 2),
    0,
  );
  return area * READABLE ** 2 < canvas.width * canvas.height;
}

/** The links between boxes of different outermost namespaces. */
function linksBetweenNamespaces({ boxes, links, groups }: LayoutRequest): Set<Link> {
  const parents = new Map(groups.map(({ name, parent }) => [name, parent]));
  const outermost = (name: string | null): string | null => {
    const parent = name === null ? null : (parents.get(name) ?? null);
    return parent === null ? name : outermost(parent);
  };
  const spaces = new Map(boxes.map(({ id, group }) => [id, outermost(group)]));
  return new Set(links.filter(({ from, to }) => spaces.get(from) !== spaces.get(to)));
}

/** Add links to a layout, each on a direct way. */
function withLinks(layout: Layout, links: ReadonlySet<Link>): Layout {
  const layers = { boxes: [], depths: new Map(), down: layout.down };
  for (const { id, from, to } of links) {
    const ends = [layout.boxes.get(from) as Box, layout.boxes.get(to) as Box] as const;
    const [a, b] = ends;
    layout.links.set(id, edgePath([], { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 }, ends, layers));
  }
  return layout;
}

/** The connected components of a request (union-find). */
export function components(request: LayoutRequest): Component[] {
  const parents = new Map<string, string>();
  const find = (id: string): string => {
    let at = id;
    for (let up = parents.get(at); up !== undefined && up !== at; up = parents.get(at)) {
      parents.set(at, parents.get(up) ?? up);
      at = up;
    }
    return at;
  };
  const join = (a: string, b: string): void => void parents.set(find(a), find(b));
  const inGroup = (name: string): string => `group ${name}`;
  for (const { id } of request.boxes) parents.set(id, id);
  for (const { name } of request.groups) parents.set(inGroup(name), inGroup(name));
  for (const { name, parent } of request.groups)
    if (parent !== null) join(inGroup(name), inGroup(parent));
  for (const { id, group } of request.boxes) if (group !== null) join(id, inGroup(group));
  for (const { from, to } of request.links) join(from, to);
  const found = new Map<string, Component>();
  for (const box of request.boxes) {
    const root = find(box.id);
    const component = found.get(root) ?? { boxes: [], links: [], groups: [] };
    component.boxes.push(box);
    found.set(root, component);
  }
  for (const link of request.links) found.get(find(link.from))?.links.push(link);
  for (const group of request.groups) found.get(find(inGroup(group.name)))?.groups.push(group);
  return [...found.values()];
}

function componentLayout(component: Component, down: boolean): Layout {
  const only = component.boxes[0];
  if (only !== undefined && component.boxes.length === 1 && component.links.length === 0) {
    const boxes = new Map([[only.id, { x: 0, y: 0, width: only.width, height: only.height }]]);
    return fitted({ boxes, links: new Map(), groups: groupsOf(component, boxes), down });
  }
  const graph = new Graph({ directed: true, multigraph: true, compound: true });
  graph.setGraph({
    rankdir: down ? "TB" : "LR",
    ranksep: component.boxes.length > FEW ? BETWEEN_LAYERS : 2 * BETWEEN_LAYERS,
    nodesep: down || component.boxes.length > FEW ? BETWEEN_BOXES / 2 : BETWEEN_BOXES,
    edgesep: BETWEEN_ARROWS,
    // As few edges as possible go back in a cycle, which makes fewer layers.
    acyclicer: "greedy",
    // Network simplex gives shorter edges, but is slow for many.
    ranker: component.boxes.length > MANY ? "tight-tree" : "network-simplex",
  });
  graph.setDefaultEdgeLabel(() => ({}));
  const groupId = (name: string): string => `group ${name}`;
  for (const { name } of component.groups) graph.setNode(groupId(name), {});
  for (const { id, width, height } of component.boxes) graph.setNode(id, { width, height });
  for (const { name, parent } of component.groups) {
    if (parent !== null) graph.setParent(groupId(name), groupId(parent));
  }
  for (const { id, group } of component.boxes)
    if (group !== null) graph.setParent(id, groupId(group));
  for (const { id, from, to, width, height } of component.links) {
    graph.setEdge(from, to, { width, height, labelpos: "c" }, id);
  }
  dagreLayout(graph);
  const boxes = new Map<string, Box>();
  for (const { id, width, height } of component.boxes) {
    const { x, y } = graph.node(id) as Point;
    boxes.set(id, { x, y, width, height });
  }
  const layers = layersOf([...boxes.values()], down);
  const links = new Map<string, EdgePath>();
  for (const { id, from, to } of component.links) {
    const { points = [], x, y } = graph.edge(from, to, id) as { points?: Point[] } & Point;
    const ends = [boxes.get(from) as Box, boxes.get(to) as Box] as const;
    links.set(id, edgePath(points, { x, y }, ends, layers));
  }
  const height = greatest(
    component.links.map((link) => (down ? link.width : link.height)),
    0,
  );
  spreadLabels([...links.values()], layers, height + 2);
  return fitted({ boxes, links, groups: groupsOf(component, boxes), down });
}

/** The boxes of namespaces: around their members, with padding and a title. */
function groupsOf(component: Component, boxes: ReadonlyMap<string, Box>): Map<string, Box> {
  const found = new Map<string, Box>();
  for (const { name, width } of component.groups.toReversed()) {
    const members = [
      ...component.boxes.filter(({ group }) => group === name).map(({ id }) => boxes.get(id)),
      ...component.groups
        .filter(({ parent }) => parent === name)
        .map((inner) => found.get(inner.name)),
    ].filter((box) => box !== undefined);
    const inner = around(members);
    if (inner === null) continue;
    const wider = Math.max(0, width - inner.width);
    found.set(name, {
      x: inner.x + wider / 2,
      y: inner.y - TITLE / 2,
      width: inner.width + wider + 2 * PADDING,
      height: inner.height + TITLE + 2 * PADDING,
    });
  }
  // Outer ones first, as they are drawn below the inner ones.
  return new Map([...found].reverse());
}

/** Complete a layout, with its upper left corner at the origin. */
function fitted({ boxes, links, groups, down }: Omit<Layout, "bounds">): Layout {
  const bends = [...links.values()]
    .flatMap(({ points }) => points)
    .map((point) => ({ ...point, width: 0, height: 0 }));
  const all = around([...boxes.values(), ...groups.values(), ...bends]);
  const { x, y, width, height } = all ?? { x: 0, y: 0, width: 0, height: 0 };
  const [left, top] = [x - width / 2, y - height / 2];
  const bounds = { left, top, width, height };
  return moved({ boxes, links, groups, bounds, down }, -left, -top);
}

/** How wide rows of components are tried, in relation to a square part of the canvas. */
const ROW_WIDTHS = [1.1, 0.9, 1.35, 1.6];
/** Another width of rows must show everything this much larger to be chosen. */
const LARGER = 1.1;

/** Arrange components in rows that fill the canvas. */
function pack(layouts: readonly Layout[], canvas: Size, down: boolean): Layout {
  // Large ones first, so that single boxes gather below.
  const sorted = layouts
    .map((component, index) => ({ component, index }))
    .sort((a, b) => size(b.component) - size(a.component) || a.index - b.index)
    .map(({ component }) => component);
  const area = layouts.reduce(
    (sum, { bounds: { width, height } }) =>
      sum + (width + BETWEEN_COMPONENTS) * (height + BETWEEN_COMPONENTS),
    0,
  );
  const widest = greatest(
    layouts.map(({ bounds }) => bounds.width),
    0,
  );
  const ideal = Math.sqrt((area * canvas.width) / canvas.height);
  const [usual = inRows([], 0), ...others] = ROW_WIDTHS.map((factor) =>
    inRows(sorted, Math.max(widest, factor * ideal)),
  );
  const zoomOf = ({ width, height }: Rows): number => zoomToFit({ width, height }, canvas);
  const best = others.reduce(
    (one, other) => (zoomOf(other) > LARGER * zoomOf(one) ? other : one),
    usual,
  );
  const bounds = { left: 0, top: 0, width: best.width, height: best.height };
  const whole: Layout = { boxes: new Map(), links: new Map(), groups: new Map(), bounds, down };
  for (const [index, component] of sorted.entries()) {
    const { x, y } = best.places[index] as Point;
    const { boxes, links, groups } = moved(component, x, y);
    for (const [id, box] of boxes) whole.boxes.set(id, box);
    for (const [id, path] of links) whole.links.set(id, path);
    for (const [name, box] of groups) whole.groups.set(name, box);
  }
  return whole;
}

interface Rows extends Size {
  /** The upper left corner of each component. */
  places: Point[];
}

/** Place components one after the other, in rows of a limited width. */
function inRows(layouts: readonly Layout[], limit: number): Rows {
  const rows: Rows = { places: [], width: 0, height: 0 };
  let [x, y] = [0, 0];
  for (const { bounds } of layouts) {
    if (x > 0 && x + bounds.width > limit) [x, y] = [0, rows.height + BETWEEN_COMPONENTS];
    rows.places.push({ x, y });
    x += bounds.width + BETWEEN_COMPONENTS;
    rows.width = Math.max(rows.width, x - BETWEEN_COMPONENTS);
    rows.height = Math.max(rows.height, y + bounds.height);
  }
  return rows;
}

/** In coarse steps, so that one more topic does not reorder components. */
const size = ({ boxes }: Layout): number => Math.ceil(Math.log2(boxes.size));
