// The graph as it is to be drawn: elements, arrows and namespaces, before anything has its place.

import type { Choices } from "./choices";
import { passes } from "./choices";
import { actionTopics } from "./folding";
import { namespaces } from "./namespaces";
import { isHidden } from "../hidden";
import type { Graph } from "../model";

export type Kind = "node" | "topic" | "service" | "action";

export interface Element {
  /** Kind and name: a node and a topic may have the same name. */
  id: string;
  kind: Kind;
  name: string;
  /** The type of a topic, service or action; empty for a node. */
  type: string;
  /** The innermost namespace that is drawn around it. */
  group: string | null;
  /** The name as read inside that namespace. */
  label: string;
  /** The type, where it is to be read in the picture. */
  second: string;
  /** What a screen reader says. */
  about: string;
}

export interface Edge {
  id: string;
  from: string;
  to: string;
  /** What flows, as the keys of the model's rates; none where nothing is counted. */
  publishers: string[];
  subscriptions: string[];
  /** The topic's name where topics are words on the arrows. */
  label: string;
  latched: boolean;
  dashed: boolean;
  bothWays: boolean;
  /** A sentence that says what this arrow is. */
  about: string;
}

export interface Group {
  name: string;
  parent: string | null;
}

export interface Picture {
  elements: Element[];
  edges: Edge[];
  groups: Group[];
  /** Whether the types are to be read. */
  typed: boolean;
}

/** So many elements leave room for their types. */
const FEW = 8;

export const idOf = (kind: Kind, name: string): string => `${kind} ${name}`;

type Sketch = Omit<Element, "group" | "label" | "second" | "about">;
type Line = Pick<Edge, "from" | "to" | "about"> & Partial<Edge>;

/** Draw what the choices ask for; `keep` names elements that stay whatever the filter says. */
export function picture(graph: Graph, choices: Choices): Picture {
  const shown = (name: string): boolean => choices.debug || !isHidden(name);
  const elements = new Map<string, Sketch>();
  const edges: Edge[] = [];
  const put = (kind: Kind, name: string, type = ""): string => {
    const id = idOf(kind, name);
    elements.set(id, { id, kind, name, type });
    return id;
  };
  const draw = (line: Line): void => {
    if (!elements.has(line.from) || !elements.has(line.to)) return;
    const id = `${line.from} > ${line.to}${line.label ? ` ${line.label}` : ""}`;
    edges.push({
      id,
      publishers: [],
      subscriptions: [],
      label: "",
      latched: false,
      dashed: false,
      bothWays: false,
      ...line,
    });
  };

  for (const node of graph.nodes) {
    if (shown(node.name) && (choices.debug || !node.own)) put("node", node.name);
  }
  const folded = new Set<string>();
  for (const action of graph.actions) {
    if (!shown(action.name)) continue;
    if (action.over_topics && choices.debug) continue;
    if (action.over_topics) for (const topic of actionTopics(action.name)) folded.add(topic);
    if (choices.actions) drawAction(graph, action, put, draw);
  }
  for (const topic of graph.topics) {
    if (!shown(topic.name) || folded.has(topic.name)) continue;
    const publishers = topic.publishers.filter(({ node }) => elements.has(idOf("node", node)));
    const subscribers = topic.subscriptions.filter(({ node }) => elements.has(idOf("node", node)));
    const dead = publishers.length === 0 || subscribers.length === 0;
    if (dead && (!choices.deadEnds || !choices.topics)) continue;
    if (choices.topics) {
      const box = put("topic", topic.name, topic.type);
      for (const { node, latch } of publishers) {
        draw({
          from: idOf("node", node),
          to: box,
          publishers: [`${topic.name} ${node}`],
          latched: latch,
          about: `${node} publishes ${topic.name}${latch ? ", latched" : ""}`,
        });
      }
      for (const { node } of subscribers) {
        draw({
          from: box,
          to: idOf("node", node),
          subscriptions: [`${topic.name} ${node}`],
          about: `${node} subscribes to ${topic.name}`,
        });
      }
    } else {
      for (const { node: publisher, latch } of publishers) {
        for (const { node: subscriber } of subscribers) {
          draw({
            from: idOf("node", publisher),
            to: idOf("node", subscriber),
            label: topic.name,
            publishers: [`${topic.name} ${publisher}`],
            subscriptions: [`${topic.name} ${subscriber}`],
            latched: latch,
            about: `${publisher} publishes ${topic.name}${latch ? ", latched," : ""} to ${subscriber}`,
          });
        }
      }
    }
  }
  if (choices.services) {
    for (const service of graph.services) {
      if (!shown(service.name)) continue;
      draw({
        from: put("service", service.name, service.type),
        to: idOf("node", service.node),
        dashed: true,
        about: `${service.node} provides ${service.name}`,
      });
    }
  }

  const near = new Set<string>();
  for (const { id, name } of elements.values()) {
    if (passes(name, choices.filter)) near.add(id);
  }
  const matched = new Set(near);
  for (const { from, to } of edges) {
    if (matched.has(from)) near.add(to);
    if (matched.has(to)) near.add(from);
  }
  const kept = [...elements.values()].filter(({ id }) => near.has(id)).sort(byKindAndName);
  const lines = edges
    .filter(({ from, to }) => (matched.has(from) || matched.has(to)) && near.has(from) && near.has(to))
    .sort((a, b) => compare(a.id, b.id));
  const leaving = tally(lines.map(({ from }) => from));
  const arriving = tally(lines.filter(({ dashed }) => !dashed).map(({ to }) => to));
  const typed = choices.types ?? kept.length <= FEW;
  const { groups, of } = namespaces(kept, choices.namespaces);
  return {
    elements: kept.map((element) => {
      const group = of.get(element.id) ?? null;
      return {
        ...element,
        group,
        label: group === null ? element.name : element.name.slice(group.length + 1),
        second: typed ? element.type : "",
        about: about(element, leaving(element.id), arriving(element.id)),
      };
    }),
    edges: lines,
    groups,
    typed,
  };
}

/** A client sends goals to the action and hears of them: one arrow tells both. */
function drawAction(
  graph: Graph,
  action: Graph["actions"][number],
  put: (kind: Kind, name: string, type: string) => string,
  draw: (line: Line) => void,
): void {
  const box = put("action", action.name, action.type);
  const server = idOf("node", action.node);
  if (!action.over_topics) {
    draw({ from: box, to: server, dashed: true, about: `${action.node} serves ${action.name}` });
    return;
  }
  const topics = new Set(actionTopics(action.name));
  const sends = new Map<string, string[]>();
  const hears = new Map<string, string[]>();
  const note = (to: Map<string, string[]>, node: string, key: string): void => {
    to.set(node, [...(to.get(node) ?? []), key]);
  };
  for (const topic of graph.topics) {
    if (!topics.has(topic.name)) continue;
    for (const { node } of topic.publishers) note(sends, node, `${topic.name} ${node}`);
    for (const { node } of topic.subscriptions) note(hears, node, `${topic.name} ${node}`);
  }
  draw({
    from: box,
    to: server,
    publishers: sends.get(action.node) ?? [],
    subscriptions: hears.get(action.node) ?? [],
    bothWays: true,
    about: `${action.node} serves ${action.name}`,
  });
  for (const node of new Set([...sends.keys(), ...hears.keys()])) {
    if (node === action.node) continue;
    const asks = sends.has(node);
    draw({
      from: asks ? idOf("node", node) : box,
      to: asks ? box : idOf("node", node),
      publishers: sends.get(node) ?? [],
      subscriptions: hears.get(node) ?? [],
      bothWays: asks && hears.has(node),
      about: asks ? `${node} sends goals to ${action.name}` : `${node} follows ${action.name}`,
    });
  }
}

function tally(ids: readonly string[]): (id: string) => number {
  const counts = new Map<string, number>();
  for (const id of ids) counts.set(id, (counts.get(id) ?? 0) + 1);
  return (id) => counts.get(id) ?? 0;
}

function about({ kind, name, type }: Sketch, out: number, into: number): string {
  const typed = type === "" ? "" : `, type ${type}`;
  if (kind === "node") return `node ${name}, publishes ${out}, subscribes ${into}`;
  if (kind === "topic") return `topic ${name}${typed}, publishers ${into}, subscribers ${out}`;
  return `${kind} ${name}${typed}`;
}

const compare = (a: string, b: string): number => (a < b ? -1 : a > b ? 1 : 0);

const byKindAndName = (a: Sketch, b: Sketch): number => compare(a.name, b.name) || compare(a.kind, b.kind);
