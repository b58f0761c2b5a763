// What of the graph its reader wants to see.

export interface Choices {
  /** Topics as boxes of their own, or as the words on the arrows between nodes. */
  topics: boolean;
  services: boolean;
  actions: boolean;
  deadEnds: boolean;
  debug: boolean;
  /** null: draw them when there is more than one namespace. */
  namespaces: boolean | null;
  /** The types of topics, services and actions; null: while there is room for them. */
  types: boolean | null;
  /** A namespace (`/robot`) or a part of a name; empty for everything. */
  filter: string;
}

export const USUAL: Choices = {
  topics: true,
  services: false,
  actions: true,
  deadEnds: true,
  debug: false,
  namespaces: null,
  types: null,
  filter: "",
};

const KEY = "fibws.graph";

/** What was chosen last time; whatever is unreadable is as usual. */
export function recall(storage: () => Pick<Storage, "getItem"> = () => localStorage): Choices {
  const choices = { ...USUAL };
  try {
    const kept: unknown = JSON.parse(storage().getItem(KEY) ?? "null");
    if (kept === null || typeof kept !== "object") return choices;
    const { topics, services, actions, deadEnds, debug, namespaces, types, filter } =
      kept as Choices;
    if (typeof topics === "boolean") choices.topics = topics;
    if (typeof services === "boolean") choices.services = services;
    if (typeof actions === "boolean") choices.actions = actions;
    if (typeof deadEnds === "boolean") choices.deadEnds = deadEnds;
    if (typeof debug === "boolean") choices.debug = debug;
    if (typeof namespaces === "boolean") choices.namespaces = namespaces;
    if (typeof types === "boolean") choices.types = types;
    if (typeof filter === "string") choices.filter = filter;
  } catch {
    // A browser may forbid storage, and anybody may have written there.
  }
  return choices;
}

export function remember(
  choices: Choices,
  storage: () => Pick<Storage, "setItem"> = () => localStorage,
): void {
  try {
    storage().setItem(KEY, JSON.stringify(choices));
  } catch {
    // Not kept, then: the page works all the same.
  }
}

/** Says whether a name is among those that the filter asks for. */
export function passes(name: string, filter: string): boolean {
  const wanted = filter.trim();
  if (wanted === "") return true;
  return wanted.startsWith("/") ? name.startsWith(wanted) : name.includes(wanted);
}
