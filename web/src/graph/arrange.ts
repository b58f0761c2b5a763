// Places for boxes and arrows, in layers from left to right. Pure: the worker runs it.

import { Graph, layout } from "@dagrejs/dagre";

import { around, type Box, moved, type Places, type Plan, type Point, type Way } from "./places";
import { layersOf, spread, way } from "./ways";

/** A part of the plan with no arrow and no namespace in common with the rest. */
type Island = Omit<Plan, "aspect">;

/** So few boxes may have more room between them. */
const FEW = 8;
/** So many have to be placed faster. */
const MANY = 40;
const BETWEEN_LAYERS = 26;
const BETWEEN_BOXES = 32;
const BETWEEN_ARROWS = 10;
const BETWEEN_ISLANDS = 36;
const INSIDE = 14;
/** Room for a namespace's name. */
const TITLE = 14;

/** Remembers the islands that it placed last, so that a change on one costs nothing on the others. */
export class Arranger {
  #kept = new Map<string, Places>();

  arrange(plan: Plan): Places {
    const next = new Map<string, Places>();
    const placed = islands(plan).map((island) => {
      const key = JSON.stringify(island);
      const places = this.#kept.get(key) ?? place(island);
      next.set(key, places);
      return places;
    });
    this.#kept = next;
    return pack(placed, plan.aspect);
  }
}

export function islands(plan: Plan): Island[] {
  const chief = new Map<string, string>();
  const find = (id: string): string => {
    let at = id;
    for (let up = chief.get(at); up !== undefined && up !== at; up = chief.get(at)) {
      chief.set(at, chief.get(up) ?? up);
      at = up;
    }
    return at;
  };
  const join = (a: string, b: string): void => void chief.set(find(a), find(b));
  const inGroup = (name: string): string => `group ${name}`;
  for (const { id } of plan.boxes) chief.set(id, id);
  for (const { name } of plan.groups) chief.set(inGroup(name), inGroup(name));
  for (const { name, parent } of plan.groups)
    if (parent !== null) join(inGroup(name), inGroup(parent));
  for (const { id, group } of plan.boxes) if (group !== null) join(id, inGroup(group));
  for (const { from, to } of plan.links) join(from, to);
  const found = new Map<string, Island>();
  for (const box of plan.boxes) {
    const root = find(box.id);
    const island = found.get(root) ?? { boxes: [], links: [], groups: [], down: plan.down };
    island.boxes.push(box);
    found.set(root, island);
  }
  for (const link of plan.links) found.get(find(link.from))?.links.push(link);
  for (const group of plan.groups) found.get(find(inGroup(group.name)))?.groups.push(group);
  return [...found.values()];
}

function place(island: Island): Places {
  const only = island.boxes[0];
  if (only !== undefined && island.boxes.length === 1 && island.links.length === 0) {
    const boxes = new Map([[only.id, { x: 0, y: 0, width: only.width, height: only.height }]]);
    return fitted({ boxes, links: new Map(), groups: groupsOf(island, boxes) });
  }
  const graph = new Graph({ directed: true, multigraph: true, compound: true });
  graph.setGraph({
    rankdir: island.down ? "TB" : "LR",
    ranksep: island.boxes.length > FEW ? BETWEEN_LAYERS : 2 * BETWEEN_LAYERS,
    nodesep: island.down ? BETWEEN_BOXES / 2 : BETWEEN_BOXES,
    edgesep: BETWEEN_ARROWS,
    // Of a ring of arrows as few as possible go back, which makes for fewer layers.
    acyclicer: "greedy",
    // Network simplex gives shorter arrows, and takes its time for many.
    ranker: island.boxes.length > MANY ? "tight-tree" : "network-simplex",
  });
  graph.setDefaultEdgeLabel(() => ({}));
  const groupId = (name: string): string => `group ${name}`;
  for (const { name } of island.groups) graph.setNode(groupId(name), {});
  for (const { id, width, height } of island.boxes) graph.setNode(id, { width, height });
  for (const { name, parent } of island.groups) {
    if (parent !== null) graph.setParent(groupId(name), groupId(parent));
  }
  for (const { id, group } of island.boxes) if (group !== null) graph.setParent(id, groupId(group));
  for (const { id, from, to, width, height } of island.links) {
    graph.setEdge(from, to, { width, height, labelpos: "c" }, id);
  }
  layout(graph);
  const boxes = new Map<string, Box>();
  for (const { id, width, height } of island.boxes) {
    const { x, y } = graph.node(id) as Point;
    boxes.set(id, { x, y, width, height });
  }
  const layers = layersOf([...boxes.values()], island.down);
  const links = new Map<string, Way>();
  for (const { id, from, to } of island.links) {
    const { points = [], x, y } = graph.edge(from, to, id) as { points?: Point[] } & Point;
    const ends = [boxes.get(from) as Box, boxes.get(to) as Box] as const;
    links.set(id, way(points, { x, y }, ends, layers));
  }
  const height = Math.max(
    0,
    ...island.links.map((link) => (island.down ? link.width : link.height)),
  );
  spread([...links.values()], layers, height + 2);
  return fitted({ boxes, links, groups: groupsOf(island, boxes) });
}

/** The boxes around namespaces: what is in them, some room, and a line for the name. */
function groupsOf(island: Island, boxes: ReadonlyMap<string, Box>): Map<string, Box> {
  const found = new Map<string, Box>();
  for (const { name, width } of island.groups.toReversed()) {
    const members = [
      ...island.boxes.filter(({ group }) => group === name).map(({ id }) => boxes.get(id)),
      ...island.groups
        .filter(({ parent }) => parent === name)
        .map((inner) => found.get(inner.name)),
    ].filter((box) => box !== undefined);
    const inner = around(members);
    if (inner === null) continue;
    const wider = Math.max(0, width - inner.width);
    found.set(name, {
      x: inner.x + wider / 2,
      y: inner.y - TITLE / 2,
      width: inner.width + wider + 2 * INSIDE,
      height: inner.height + TITLE + 2 * INSIDE,
    });
  }
  // The outer ones first: they are drawn below the inner ones.
  return new Map([...found].reverse());
}

/** The same with its upper left corner at 0, 0. */
function fitted({ boxes, links, groups }: Omit<Places, "bounds">): Places {
  const bends = [...links.values()]
    .flatMap(({ points }) => points)
    .map((point) => ({ ...point, width: 0, height: 0 }));
  const all = around([...boxes.values(), ...groups.values(), ...bends]);
  const { x, y, width, height } = all ?? { x: 0, y: 0, width: 0, height: 0 };
  const [left, top] = [x - width / 2, y - height / 2];
  const bounds = { left, top, width, height };
  return moved({ boxes, links, groups, bounds }, -left, -top);
}

/** Side by side in rows, as wide as the eye has room for; the order stays. */
function pack(islands: readonly Places[], aspect: number): Places {
  const area = islands.reduce(
    (sum, { bounds: { width, height } }) =>
      sum + (width + BETWEEN_ISLANDS) * (height + BETWEEN_ISLANDS),
    0,
  );
  const widest = Math.max(0, ...islands.map(({ bounds }) => bounds.width));
  const limit = Math.max(widest, 1.1 * Math.sqrt(area * aspect));
  const bounds = { left: 0, top: 0, width: 0, height: 0 };
  const all: Places = { boxes: new Map(), links: new Map(), groups: new Map(), bounds };
  let [x, y, high] = [0, 0, 0];
  // Large ones first: loose ends then gather below, and do not break up the rows.
  const rows = islands
    .map((island, index) => ({ island, index }))
    .sort((a, b) => size(b.island) - size(a.island) || a.index - b.index);
  for (const { island } of rows) {
    const { width, height } = island.bounds;
    if (x > 0 && x + width > limit) [x, y, high] = [0, y + high + BETWEEN_ISLANDS, 0];
    const { boxes, links, groups } = moved(island, x, y);
    for (const [id, box] of boxes) all.boxes.set(id, box);
    for (const [id, way] of links) all.links.set(id, way);
    for (const [name, box] of groups) all.groups.set(name, box);
    x += width + BETWEEN_ISLANDS;
    high = Math.max(high, height);
    bounds.width = Math.max(bounds.width, x - BETWEEN_ISLANDS);
    bounds.height = y + high;
  }
  return all;
}

/** In coarse steps, so that one more topic does not make two islands change places. */
const size = ({ boxes }: Places): number => Math.ceil(Math.log2(boxes.size));
