// The graph as it is to be drawn: elements, arrows and namespaces, before anything has its place.

import { isHidden } from "../hidden";
import type { ActionInfo, Graph, TopicInfo } from "../model";
import { flowKey } from "../rates";
import { actionTopics } from "./action_topics";
import type { Choices } from "./choices";
import { passes } from "./choices";
import { namespaces } from "./namespaces";

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

/** Draw what the choices ask for. */
export function picture(graph: Graph, choices: Choices): Picture {
  const { elements, edges } = chosen(gathered(graph, choices), choices.filter);
  const leaving = tally(edges.map(({ from }) => from));
  const arriving = tally(edges.filter(({ dashed }) => !dashed).map(({ to }) => to));
  const typed = choices.types ?? elements.length <= FEW;
  const { groups, of } = namespaces(elements, choices.namespaces);
  return {
    elements: elements.map((element) => {
      const group = of.get(element.id) ?? null;
      return {
        ...element,
        group,
        label: group === null ? element.name : element.name.slice(group.length + 1),
        second: typed ? element.type : "",
        about: about(element, leaving(element.id), arriving(element.id)),
      };
    }),
    edges,
    groups,
    typed,
  };
}

/** Elements and the arrows between them. */
class Draft {
  readonly elements = new Map<string, Sketch>();
  readonly edges: Edge[] = [];

  /** Have an element in it; returns its id. */
  put(kind: Kind, name: string, type = ""): string {
    const id = idOf(kind, name);
    this.elements.set(id, { id, kind, name, type });
    return id;
  }

  has(kind: Kind, name: string): boolean {
    return this.elements.has(idOf(kind, name));
  }

  /** Have an arrow in it, if both its ends are. */
  draw(line: Line): void {
    if (!this.elements.has(line.from) || !this.elements.has(line.to)) return;
    const id = `${line.from} > ${line.to}${line.label ? ` ${line.label}` : ""}`;
    this.edges.push({
      id,
      publishers: [],
      subscriptions: [],
      label: "",
      latched: false,
      dashed: false,
      bothWays: false,
      ...line,
    });
  }
}

/** All that the choices ask for, whatever its name. */
function gathered(graph: Graph, choices: Choices): Draft {
  const shown = ({ name }: { name: string }): boolean => choices.debug || !isHidden(name);
  const draft = new Draft();
  for (const node of graph.nodes.filter(shown)) {
    if (choices.debug || !node.own) draft.put("node", node.name);
  }
  const folded = new Set<string>();
  for (const action of graph.actions.filter(shown)) {
    if (action.over_topics && choices.debug) continue;
    if (action.over_topics) for (const topic of actionTopics(action.name)) folded.add(topic);
    if (choices.actions) drawAction(draft, action, graph.topics);
  }
  for (const topic of graph.topics.filter(shown)) {
    if (!folded.has(topic.name)) drawTopic(draft, topic, choices);
  }
  for (const service of choices.services ? graph.services.filter(shown) : []) {
    draft.draw({
      from: draft.put("service", service.name, service.type),
      to: idOf("node", service.node),
      dashed: true,
      about: `${service.node} provides ${service.name}`,
    });
  }
  return draft;
}

/** Those that pass the filter, their neighbours, and the arrows that either has to the first. */
function chosen(draft: Draft, filter: string): { elements: Sketch[]; edges: Edge[] } {
  const all = [...draft.elements.values()];
  const matched = new Set(all.filter(({ name }) => passes(name, filter)).map(({ id }) => id));
  const edges = draft.edges.filter(({ from, to }) => matched.has(from) || matched.has(to));
  const near = new Set([...matched, ...edges.flatMap(({ from, to }) => [from, to])]);
  return {
    elements: all.filter(({ id }) => near.has(id)).sort(byKindAndName),
    edges: edges.sort((a, b) => compare(a.id, b.id)),
  };
}

/** As a box with arrows to and from it, or as arrows from node to node. */
function drawTopic(draft: Draft, topic: TopicInfo, { topics, deadEnds }: Choices): void {
  const { name, type } = topic;
  const publishers = topic.publishers.filter(({ node }) => draft.has("node", node));
  const subscribers = topic.subscriptions.filter(({ node }) => draft.has("node", node));
  const dead = publishers.length === 0 || subscribers.length === 0;
  if (dead && (!deadEnds || !topics)) return;
  if (topics) {
    const box = draft.put("topic", name, type);
    for (const { node, latch } of publishers) {
      draft.draw({
        from: idOf("node", node),
        to: box,
        publishers: [flowKey(name, node)],
        latched: latch,
        about: `${node} publishes ${name}${latch ? ", latched" : ""}`,
      });
    }
    for (const { node } of subscribers) {
      draft.draw({
        from: box,
        to: idOf("node", node),
        subscriptions: [flowKey(name, node)],
        about: `${node} subscribes to ${name}`,
      });
    }
    return;
  }
  for (const { node: publisher, latch } of publishers) {
    for (const { node: subscriber } of subscribers) {
      draft.draw({
        from: idOf("node", publisher),
        to: idOf("node", subscriber),
        label: name,
        publishers: [flowKey(name, publisher)],
        subscriptions: [flowKey(name, subscriber)],
        latched: latch,
        about: `${publisher} publishes ${name}${latch ? ", latched," : ""} to ${subscriber}`,
      });
    }
  }
}

/** A client sends goals to the action and hears of them: one arrow tells both. */
function drawAction(draft: Draft, action: ActionInfo, all: readonly TopicInfo[]): void {
  const box = draft.put("action", action.name, action.type);
  const server = idOf("node", action.node);
  if (!action.over_topics) {
    draft.draw({
      from: box,
      to: server,
      dashed: true,
      about: `${action.node} serves ${action.name}`,
    });
    return;
  }
  const topics = new Set(actionTopics(action.name));
  const sends = new Map<string, string[]>();
  const hears = new Map<string, string[]>();
  const note = (to: Map<string, string[]>, node: string, key: string): void => {
    to.set(node, [...(to.get(node) ?? []), key]);
  };
  for (const topic of all) {
    if (!topics.has(topic.name)) continue;
    for (const { node } of topic.publishers) note(sends, node, flowKey(topic.name, node));
    for (const { node } of topic.subscriptions) note(hears, node, flowKey(topic.name, node));
  }
  draft.draw({
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
    draft.draw({
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

const byKindAndName = (a: Sketch, b: Sketch): number =>
  compare(a.name, b.name) || compare(a.kind, b.kind);
