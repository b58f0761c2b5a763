/** Lays out boxes and edges in layers, by dagre. It has no side effects and runs in the worker. */

import { layout as dagreLayout, Graph } from "@dagrejs/dagre";
import { edgePath, layersOf, spreadLabels } from "./edge_paths";
import {
  around,
  type Box,
  type EdgePath,
  type Layout,
  type LayoutRequest,
  moved,
  type Point,
} from "./layout_types";

/** A part of the request without an edge or namespace in common with the rest. */
type Component = Omit<LayoutRequest, "aspect">;

/** Up to this many boxes get more space between layers. */
const FEW = 8;
/** More boxes than this need the faster algorithm. */
const MANY = 40;
const BETWEEN_LAYERS = 26;
const BETWEEN_BOXES = 32;
const BETWEEN_ARROWS = 10;
const BETWEEN_COMPONENTS = 36;
/** The padding of a namespace, and the height of its title. */
const PADDING = 14;
const TITLE = 14;

/** Caches the components of the last layout, since most changes concern only one. */
export class LayoutEngine {
  #cache = new Map<string, Layout>();

  layOut(request: LayoutRequest): Layout {
    const cache = new Map<string, Layout>();
    const layouts = components(request).map((component) => {
      const key = JSON.stringify(component);
      const layout = this.#cache.get(key) ?? componentLayout(component);
      cache.set(key, layout);
      return layout;
    });
    this.#cache = cache;
    return pack(layouts, request.aspect);
  }
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
    const component = found.get(root) ?? { boxes: [], links: [], groups: [], down: request.down };
    component.boxes.push(box);
    found.set(root, component);
  }
  for (const link of request.links) found.get(find(link.from))?.links.push(link);
  for (const group of request.groups) found.get(find(inGroup(group.name)))?.groups.push(group);
  return [...found.values()];
}

function componentLayout(component: Component): Layout {
  const only = component.boxes[0];
  if (only !== undefined && component.boxes.length === 1 && component.links.length === 0) {
    const boxes = new Map([[only.id, { x: 0, y: 0, width: only.width, height: only.height }]]);
    return fitted({ boxes, links: new Map(), groups: groupsOf(component, boxes) });
  }
  const graph = new Graph({ directed: true, multigraph: true, compound: true });
  graph.setGraph({
    rankdir: component.down ? "TB" : "LR",
    ranksep: component.boxes.length > FEW ? BETWEEN_LAYERS : 2 * BETWEEN_LAYERS,
    nodesep: component.down ? BETWEEN_BOXES / 2 : BETWEEN_BOXES,
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
  const layers = layersOf([...boxes.values()], component.down);
  const links = new Map<string, EdgePath>();
  for (const { id, from, to } of component.links) {
    const { points = [], x, y } = graph.edge(from, to, id) as { points?: Point[] } & Point;
    const ends = [boxes.get(from) as Box, boxes.get(to) as Box] as const;
    links.set(id, edgePath(points, { x, y }, ends, layers));
  }
  const height = Math.max(
    0,
    ...component.links.map((link) => (component.down ? link.width : link.height)),
  );
  spreadLabels([...links.values()], layers, height + 2);
  return fitted({ boxes, links, groups: groupsOf(component, boxes) });
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
function fitted({ boxes, links, groups }: Omit<Layout, "bounds">): Layout {
  const bends = [...links.values()]
    .flatMap(({ points }) => points)
    .map((point) => ({ ...point, width: 0, height: 0 }));
  const all = around([...boxes.values(), ...groups.values(), ...bends]);
  const { x, y, width, height } = all ?? { x: 0, y: 0, width: 0, height: 0 };
  const [left, top] = [x - width / 2, y - height / 2];
  const bounds = { left, top, width, height };
  return moved({ boxes, links, groups, bounds }, -left, -top);
}

/** Arrange components in rows that fill the aspect ratio. */
function pack(layouts: readonly Layout[], aspect: number): Layout {
  const area = layouts.reduce(
    (sum, { bounds: { width, height } }) =>
      sum + (width + BETWEEN_COMPONENTS) * (height + BETWEEN_COMPONENTS),
    0,
  );
  const widest = Math.max(0, ...layouts.map(({ bounds }) => bounds.width));
  const limit = Math.max(widest, 1.1 * Math.sqrt(area * aspect));
  const bounds = { left: 0, top: 0, width: 0, height: 0 };
  const whole: Layout = { boxes: new Map(), links: new Map(), groups: new Map(), bounds };
  let [x, y, high] = [0, 0, 0];
  // Large ones first, so that single boxes gather below.
  const sorted = layouts
    .map((component, index) => ({ component, index }))
    .sort((a, b) => size(b.component) - size(a.component) || a.index - b.index);
  for (const { component } of sorted) {
    const { width, height } = component.bounds;
    if (x > 0 && x + width > limit) [x, y, high] = [0, y + high + BETWEEN_COMPONENTS, 0];
    const { boxes, links, groups } = moved(component, x, y);
    for (const [id, box] of boxes) whole.boxes.set(id, box);
    for (const [id, path] of links) whole.links.set(id, path);
    for (const [name, box] of groups) whole.groups.set(name, box);
    x += width + BETWEEN_COMPONENTS;
    high = Math.max(high, height);
    bounds.width = Math.max(bounds.width, x - BETWEEN_COMPONENTS);
    bounds.height = y + high;
  }
  return whole;
}

/** In coarse steps, so that one more topic does not reorder components. */
const size = ({ boxes }: Layout): number => Math.ceil(Math.log2(boxes.size));
