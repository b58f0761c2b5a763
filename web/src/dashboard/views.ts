/** What a pane of the dashboard can show: panels of topics, and pieces of other tabs. */
import { isHidden } from "../hidden_names";
import type { Graph } from "../model";
import { KINDS } from "../panels/kinds";
import type { Config, Panel } from "../panels/panel";
import type { Context } from "./context";

export interface ViewKind {
  /** Its name in layouts, which stays. */
  readonly name: string;
  readonly label: string;
  /** What it can show of a graph: names of topics, services or actions, or "" for a view of its own. */
  offers(graph: Graph): readonly string[];
  /** The type of a name in the graph; undefined while the view cannot be made. */
  typeOf(graph: Graph, name: string): string | undefined;
  make(context: Context, name: string, type: string, config: Config): Promise<Panel>;
}

/** The views of topics for which there are panels: picture, map, diagnostics, and so on. */
const PANELS: readonly ViewKind[] = KINDS.map(({ id, label, types, load }) => {
  // A scene is made of many topics, and begins with those that there are.
  const isWhole = id === "scene";
  return {
    name: id,
    label,
    offers: ({ topics }) => {
      const found = shown(topics.filter(({ type }) => types.includes(type)));
      if (!isWhole) return found;
      return found.length === 0 ? [] : [""];
    },
    typeOf: ({ topics }, name) => {
      if (isWhole && name === "") return "";
      return topics.find((topic) => topic.name === name && types.includes(topic.type))?.type;
    },
    make: async ({ hub, model }, name, type, config) =>
      (await load()).makePanel(hub, model, name, type, config),
  };
});

const PIECES: readonly ViewKind[] = [
  {
    name: "plot",
    label: "Plot",
    offers: ({ topics }) => ["", ...shown(topics)],
    typeOf: ({ topics }, name) =>
      name === "" ? "" : topics.find((topic) => topic.name === name)?.type || undefined,
    make: async (context, name, type, config) =>
      (await import("./pieces")).plotPanel(context, name, type, config),
  },
  {
    name: "transitions",
    label: "State transitions",
    offers: ({ topics }) => ["", ...shown(topics)],
    typeOf: ({ topics }, name) =>
      name === "" ? "" : topics.find((topic) => topic.name === name)?.type || undefined,
    make: async (context, name, type, config) =>
      (await import("./pieces")).transitionsPanel(context, name, type, config),
  },
  {
    name: "echo",
    label: "Echo",
    offers: ({ topics }) => shown(topics),
    typeOf: ({ topics }, name) => topics.find((topic) => topic.name === name)?.type || undefined,
    make: async (context, name, type) => (await import("./pieces")).echoPanel(context, name, type),
  },
  {
    name: "action",
    label: "Action",
    offers: ({ actions }) => shown(actions),
    typeOf: ({ actions }, name) =>
      actions.find((action) => action.name === name)?.type || undefined,
    make: async (context, name) => (await import("./pieces")).actionPanel(context, name),
  },
  {
    name: "service",
    label: "Service",
    offers: ({ services }) => shown(services),
    typeOf: ({ services }, name) =>
      services.find((service) => service.name === name)?.type || undefined,
    make: async (context, name, type) =>
      (await import("./pieces")).servicePanel(context, name, type),
  },
  {
    name: "console",
    label: "Console",
    offers: () => [""],
    typeOf: () => "",
    make: async (context, _name, _type, config) =>
      (await import("./pieces")).consolePanel(context, config),
  },
];

export const VIEWS: readonly ViewKind[] = [...PANELS, ...PIECES];

export function viewNamed(name: string): ViewKind | undefined {
  return VIEWS.find((view) => view.name === name);
}

function shown(all: readonly { readonly name: string }[]): string[] {
  return [...new Set(all.map(({ name }) => name))].filter((name) => !isHidden(name)).sort();
}
