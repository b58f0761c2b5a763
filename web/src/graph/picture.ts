/** What of the graph is drawn: elements, edges and namespaces, not yet laid out. */

import { type Filter, fieldsOf } from "../filter";
import { isHidden } from "../hidden_names";
import type { ActionInfo, ConflictInfo, Graph, TopicInfo } from "../model";
import { flowKey } from "../rates";
import { conflictText, isOtherType, NO_MESSAGES, TopicUsers } from "./conflicts";
import { namespaces } from "./namespaces";
import type { GraphOptions } from "./options";

export type Kind = "node" | "topic" | "service" | "action";

export interface Element {
  /** Kind and name, as a node and a topic may have the same name. */
  id: string;
  kind: Kind;
  name: string;
  /** The type of a topic, service or action; empty for a node. */
  type: string;
  /** The innermost drawn namespace around it. */
  group: string | null;
  /** The name within that namespace. */
  label: string;
  /** The second line of text: the type, if types are shown; the state of an unreachable node. */
  second: string;
  /** Why a node does not answer; empty for all other elements. */
  fault: string;
  /** The name of the other hub that a node is connected to; empty for all other elements. */
  hub: string;
  /** The description for screen readers. */
  about: string;
}

export interface Edge {
  id: string;
  from: string;
  to: string;
  /** The keys of its rates in the model; none if its messages are not counted. */
  publishers: string[];
  subscriptions: string[];
  /** The topic's name, if topics are drawn as edges. */
  label: string;
  latched: boolean;
  dashed: boolean;
  bothWays: boolean;
  /** What keeps messages from passing: another type than the topic's, or `NO_MESSAGES`. */
  conflict: string;
  /** Whether its messages may pass between ROS 1 nodes without the hub, which cannot count them. */
  direct: boolean;
  /** A sentence that describes the edge. */
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
  /** Whether types are shown. */
  typed: boolean;
}

/** Up to this many elements, types are shown by default. */
const FEW = 8;

/** The topics of an action over topics, as in ROS 1. */
const ACTION_TOPICS = ["goal", "cancel", "status", "feedback", "result"];

const topicsOf = ({ name }: ActionInfo): string[] => ACTION_TOPICS.map((each) => `${name}/${each}`);

export const idOf = (kind: Kind, name: string): string => `${kind} ${name}`;

/** An element before namespaces are known; with the node that a service or action is part of. */
type Sketch = Omit<Element, "group" | "label" | "second" | "about"> & {
  node?: string;
  /** The other types with which nodes use a topic. */
  others?: readonly string[];
};
type Line = Pick<Edge, "from" | "to" | "about"> & Partial<Edge>;

/** Choose the part of the graph that is drawn; `busy` says which flows had messages lately. */
export function picture(
  graph: Graph,
  options: GraphOptions,
  busy: (flow: string) => boolean = () => true,
): Picture {
  const draft = collected(graph, options);
  if (!options.quiet) removeQuiet(draft, busy);
  const { elements, edges } = filtered(draft, options.filter);
  const outgoing = counter(edges.map(({ from }) => from));
  const incoming = counter(edges.filter(({ dashed }) => !dashed).map(({ to }) => to));
  const typed = options.types ?? elements.length <= FEW;
  const { groups, of } = namespaces(elements, options.namespaces);
  return {
    elements: elements.map(({ node: _node, others = [], ...element }) => {
      const group = of.get(element.id) ?? null;
      return {
        ...element,
        group,
        label: group === null ? element.name : element.name.slice(group.length + 1),
        second: secondLine({ ...element, others }, typed),
        about: description({ ...element, others }, outgoing(element.id), incoming(element.id)),
      };
    }),
    edges,
    groups,
    typed,
  };
}

/** Collects elements and the edges between them. */
class PictureDraft {
  readonly elements = new Map<string, Sketch>();
  edges: Edge[] = [];

  /** Add an element; returns its id. */
  addElement(kind: Kind, name: string, type = "", node = "", fault = "", hub = ""): string {
    const id = idOf(kind, name);
    this.elements.set(id, { id, kind, name, type, node, fault, hub });
    return id;
  }

  /** Mark a topic that nodes use with other types, too. */
  addTypes(id: string, others: readonly string[]): void {
    const element = this.elements.get(id);
    if (element !== undefined && others.length > 0) this.elements.set(id, { ...element, others });
  }

  has(kind: Kind, name: string): boolean {
    return this.elements.has(idOf(kind, name));
  }

  /** Add an edge, if both its ends are elements. */
  addEdge(line: Line): void {
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
      conflict: "",
      direct: false,
      ...line,
    });
  }
}

/** All elements and edges that the options ask for, before filtering. */
function collected(graph: Graph, options: GraphOptions): PictureDraft {
  const shown = ({ name }: { name: string }): boolean => options.debug || !isHidden(name);
  const draft = new PictureDraft();
  for (const node of graph.nodes.filter(shown)) {
    if (options.debug || !node.own) {
      draft.addElement("node", node.name, "", "", node.fault, node.hub);
    }
  }
  const users = new TopicUsers(graph);
  const actionTopics = new Set<string>();
  for (const action of graph.actions.filter(shown)) {
    if (action.over_topics && options.debug) continue;
    if (action.over_topics) for (const topic of topicsOf(action)) actionTopics.add(topic);
    if (options.actions) addAction(draft, action, graph.topics);
  }
  for (const topic of graph.topics.filter(shown)) {
    if (!actionTopics.has(topic.name)) addTopic(draft, topic, users, options);
  }
  for (const service of options.services ? graph.services.filter(shown) : []) {
    draft.addEdge({
      from: draft.addElement("service", service.name, service.type, service.node),
      to: idOf("node", service.node),
      dashed: true,
      about: `${service.node} provides ${service.name}`,
    });
  }
  return draft;
}

/** Remove the elements and edges without messages; a service stays with its node. */
function removeQuiet(draft: PictureDraft, busy: (flow: string) => boolean): void {
  const loud = new Set<string>();
  for (const { from, to, publishers, subscriptions } of draft.edges) {
    if ([...publishers, ...subscriptions].some(busy)) loud.add(from).add(to);
  }
  for (const { id, kind, node = "" } of draft.elements.values()) {
    const isPart = kind === "service" || kind === "action";
    if (isPart && loud.has(idOf("node", node))) loud.add(id);
  }
  for (const id of draft.elements.keys()) if (!loud.has(id)) draft.elements.delete(id);
  draft.edges = draft.edges.filter(({ from, to }) => loud.has(from) && loud.has(to));
}

/** The elements that match the filter, their neighbours, and the edges between both. */
function filtered(draft: PictureDraft, filter: Filter): { elements: Sketch[]; edges: Edge[] } {
  const all = [...draft.elements.values()].filter((each) => !filter.excludes(...fieldsOf(each)));
  const ids = new Set(all.map(({ id }) => id));
  const matching = new Set(
    all.filter((each) => filter.matches(...fieldsOf(each))).map(({ id }) => id),
  );
  const edges = draft.edges.filter(
    ({ from, to, label }) =>
      ids.has(from) &&
      ids.has(to) &&
      !filter.excludes(label) &&
      (matching.has(from) || matching.has(to) || (label !== "" && filter.matches(label))),
  );
  const shown = new Set([...matching, ...edges.flatMap(({ from, to }) => [from, to])]);
  return {
    elements: all.filter(({ id }) => shown.has(id)).sort(byNameAndKind),
    edges: edges.sort((a, b) => compare(a.id, b.id)),
  };
}

/** Add a topic, as an element or as edges from node to node. */
function addTopic(
  draft: PictureDraft,
  topic: TopicInfo,
  users: TopicUsers,
  { topics, deadEnds }: GraphOptions,
): void {
  const { name, type } = topic;
  const all = users.of(topic).filter(({ node }) => draft.has("node", node));
  const publishers = all.filter(({ publishes }) => publishes);
  const subscribers = all.filter(({ publishes }) => !publishes);
  const isDeadEnd = publishers.length === 0 || subscribers.length === 0;
  if (isDeadEnd && (!deadEnds || !topics)) return;
  const latchedText = (latch: boolean): string => (latch ? ", latched" : "");
  if (topics) {
    const box = draft.addElement("topic", name, type);
    const others = topic.conflicts.filter((each) => isOtherType(each, topic));
    draft.addTypes(box, [...new Set(others.map((each) => each.type))].sort());
    for (const user of publishers) {
      const { node, latch, conflict } = user;
      draft.addEdge({
        from: idOf("node", node),
        to: box,
        publishers: conflict === null ? [flowKey(name, node)] : [],
        latched: latch,
        conflict: flag(conflict, topic),
        direct: user.isRos1 && subscribers.some(({ isRos1 }) => isRos1),
        about:
          conflict === null
            ? `${node} publishes ${name}${latchedText(latch)}`
            : `${node}, ${name}: ${conflictText(conflict, topic)}`,
      });
    }
    for (const user of subscribers) {
      const { node, conflict } = user;
      draft.addEdge({
        from: box,
        to: idOf("node", node),
        subscriptions: conflict === null ? [flowKey(name, node)] : [],
        conflict: flag(conflict, topic),
        direct: user.isRos1 && publishers.some(({ isRos1 }) => isRos1),
        about:
          conflict === null
            ? `${node} subscribes to ${name}`
            : `${node}, ${name}: ${conflictText(conflict, topic)}`,
      });
    }
    return;
  }
  for (const publisher of publishers) {
    for (const subscriber of subscribers) {
      const conflict = users.conflict(publisher, subscriber, topic);
      const { node: from, latch } = publisher;
      const { node: to } = subscriber;
      draft.addEdge({
        from: idOf("node", from),
        to: idOf("node", to),
        label: name,
        publishers: conflict === null ? [flowKey(name, from)] : [],
        subscriptions: conflict === null ? [flowKey(name, to)] : [],
        latched: latch,
        conflict: flag(conflict, topic),
        direct: publisher.isRos1 && subscriber.isRos1,
        about:
          conflict === null
            ? `${from} publishes ${name}${latch ? ", latched," : ""} to ${to}`
            : `${from} sends no messages on ${name} to ${to}: ` +
              `${conflict.node} ${conflictText(conflict, topic)}`,
      });
    }
  }
}

/** The short text at an edge for a conflict; empty for none. */
function flag(conflict: ConflictInfo | null, topic: TopicInfo): string {
  if (conflict === null) return "";
  return isOtherType(conflict, topic) ? conflict.type : NO_MESSAGES;
}

/** Add an action. One edge stands for what a client sends and receives. */
function addAction(draft: PictureDraft, action: ActionInfo, all: readonly TopicInfo[]): void {
  const box = draft.addElement("action", action.name, action.type, action.node);
  const server = idOf("node", action.node);
  if (!action.over_topics) {
    draft.addEdge({
      from: box,
      to: server,
      dashed: true,
      about: `${action.node} serves ${action.name}`,
    });
    return;
  }
  const topics = new Set(topicsOf(action));
  const published = new Map<string, string[]>();
  const subscribed = new Map<string, string[]>();
  const note = (to: Map<string, string[]>, node: string, key: string): void => {
    to.set(node, [...(to.get(node) ?? []), key]);
  };
  for (const topic of all) {
    if (!topics.has(topic.name)) continue;
    for (const { node } of topic.publishers) note(published, node, flowKey(topic.name, node));
    for (const { node } of topic.subscriptions) note(subscribed, node, flowKey(topic.name, node));
  }
  draft.addEdge({
    from: box,
    to: server,
    publishers: published.get(action.node) ?? [],
    subscriptions: subscribed.get(action.node) ?? [],
    bothWays: true,
    about: `${action.node} serves ${action.name}`,
  });
  for (const node of new Set([...published.keys(), ...subscribed.keys()])) {
    if (node === action.node) continue;
    const isClient = published.has(node);
    draft.addEdge({
      from: isClient ? idOf("node", node) : box,
      to: isClient ? box : idOf("node", node),
      publishers: published.get(node) ?? [],
      subscriptions: subscribed.get(node) ?? [],
      bothWays: isClient && subscribed.has(node),
      about: isClient ? `${node} sends goals to ${action.name}` : `${node} monitors ${action.name}`,
    });
  }
}

function counter(ids: readonly string[]): (id: string) => number {
  const counts = new Map<string, number>();
  for (const id of ids) counts.set(id, (counts.get(id) ?? 0) + 1);
  return (id) => counts.get(id) ?? 0;
}

/** The text below an element's name. */
function secondLine({ type, fault, hub, others = [] }: Sketch, typed: boolean): string {
  if (fault !== "") return "⚠ unreachable";
  if (others.length > 0) return `⚠ ${others.length + 1} types`;
  if (hub !== "") return `hub ${hub}`;
  return typed ? type : "";
}

function description(
  { kind, name, type, fault, hub, others = [] }: Sketch,
  out: number,
  into: number,
): string {
  const typed = type === "" ? "" : `, type ${[type, ...others].join(" and ")}`;
  const state = fault === "" ? "" : `, unreachable: ${fault}`;
  const place = hub === "" ? "" : ` of hub ${hub}`;
  if (kind === "node") return `node ${name}${place}, publishes ${out}, subscribes ${into}${state}`;
  if (kind === "topic") return `topic ${name}${typed}, publishers ${into}, subscribers ${out}`;
  return `${kind} ${name}${typed}`;
}

const compare = (a: string, b: string): number => (a < b ? -1 : a > b ? 1 : 0);

const byNameAndKind = (a: Sketch, b: Sketch): number =>
  compare(a.name, b.name) || compare(a.kind, b.kind);
