import type { Filter } from "../filter";

/** What the graph shows. */
export interface GraphOptions {
  /** Topics as elements of their own, or as labels of the edges between nodes. */
  topics: boolean;
  services: boolean;
  actions: boolean;
  deadEnds: boolean;
  /** Nodes and topics without messages. */
  quiet: boolean;
  debug: boolean;
  /** null: only if there is more than one. */
  namespaces: boolean | null;
  /** The types of topics, services and actions; null: only in small graphs. */
  types: boolean | null;
  filter: Filter;
}
