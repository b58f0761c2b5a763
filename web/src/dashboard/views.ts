/** What a pane of the dashboard can show: panels of topics, and pieces of other tabs. */
import { isHidden } from "../hidden_names";
import type { Graph } from "../model";
import { KINDS } from "../panels/kinds";
import type { Config, Panel } from "../panels/panel";
import type { MakeView } from "../view";
import type { Context } from "./context";
import { currentName } from "./view_names";

/** The type of the service of a server of dynamic_reconfigure. */
const RECONFIGURE = "dynamic_reconfigure/Reconfigure";

export interface ViewKind {
  /** Its name in layouts, which stays. */
  readonly name: string;
  readonly label: string;
  /** Whether it publishes, calls or sets something: a recording takes nothing. */
  readonly publishes?: boolean | undefined;
  /** What it can show of a graph: names of topics, services or actions, or "" for a view of its own. */
  offers(graph: Graph): readonly string[];
  /** The type of a name in the graph; undefined while the view cannot be made. */
  typeOf(graph: Graph, name: string): string | undefined;
  make(context: Context, name: string, type: string, config: Config): Promise<Panel>;
}

/** The views of topics for which there are panels: picture, map, diagnostics, and so on. */
const PANELS: readonly ViewKind[] = KINDS.map(({ id, label, types, publishes, load }) => {
  // A scene is made of many topics, and begins with those that there are.
  const isWhole = id === "3d";
  return {
    name: id,
    label,
    publishes,
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

function typeOfTopic({ topics }: Graph, name: string): string | undefined {
  return topics.find((topic) => topic.name === name)?.type || undefined;
}

const PIECES: readonly ViewKind[] = [
  {
    name: "plot",
    label: "Plot",
    offers: ({ topics }) => ["", ...shown(topics)],
    typeOf: (graph, name) => (name === "" ? "" : typeOfTopic(graph, name)),
    make: async (context, name, type, config) =>
      (await import("./pieces")).plotPanel(context, name, type, config),
  },
  {
    name: "transitions",
    label: "State transitions",
    offers: ({ topics }) => ["", ...shown(topics)],
    typeOf: (graph, name) => (name === "" ? "" : typeOfTopic(graph, name)),
    make: async (context, name, type, config) =>
      (await import("./pieces")).transitionsPanel(context, name, type, config),
  },
  {
    name: "raw",
    label: "Raw messages",
    offers: ({ topics }) => shown(topics),
    typeOf: typeOfTopic,
    make: async (context, name, type) => (await import("./pieces")).echoPanel(context, name, type),
  },
  {
    name: "publish",
    label: "Publish",
    publishes: true,
    offers: ({ topics }) => shown(topics.filter(({ type }) => type !== "")),
    typeOf: typeOfTopic,
    make: async (context, name, type) =>
      (await import("./pieces")).publishPanel(context, name, type),
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

/** Tabs of the page as a whole. */
const TABS: readonly ViewKind[] = [
  tab(
    "graph",
    "Graph",
    false,
    ({ nodes }) => nodes.length > 0,
    () => import("../graph/view"),
  ),
  tab(
    "topics",
    "Topics",
    false,
    () => true,
    () => import("../topics/view"),
  ),
  tab(
    "services",
    "Services",
    true,
    () => true,
    () => import("../services/view"),
  ),
  tab(
    "parameters",
    "Parameters",
    true,
    () => true,
    () => import("../parameters/view"),
  ),
  tab(
    "reconfigure",
    "Reconfigure",
    true,
    ({ services }) => services.some(({ type }) => type === RECONFIGURE),
    () => import("../reconfigure/view"),
  ),
];

function tab(
  name: string,
  label: string,
  publishes: boolean,
  isThere: (graph: Graph) => boolean,
  load: () => Promise<{ makeView: MakeView }>,
): ViewKind {
  return {
    name,
    label,
    publishes,
    offers: (graph) => (isThere(graph) ? [""] : []),
    typeOf: () => "",
    make: async (context, _name, _type, config) => {
      const [{ makeView }, { tabPanel }] = await Promise.all([load(), import("./pieces")]);
      return tabPanel(makeView, name, context, config);
    },
  };
}

export const VIEWS: readonly ViewKind[] = [...PANELS, ...PIECES, ...TABS];

export function viewNamed(name: string): ViewKind | undefined {
  return VIEWS.find((view) => view.name === currentName(name));
}

function shown(all: readonly { readonly name: string }[]): string[] {
  return [...new Set(all.map(({ name }) => name))].filter((name) => !isHidden(name)).sort();
}
