/** Pieces of other tabs as panels: plot, states, echo, a service, an action, and the console. */
import { ActionPage } from "../actions/action_page";
import { ConsoleView } from "../console/view";
import { h, replace } from "../dom";
import { dropFields } from "../field_drag";
import { isHidden } from "../hidden_names";
import type { Model } from "../model";
import type { Config, Panel } from "../panels/panel";
import { ServicePage } from "../services/service_page";
import { Echo } from "../topics/echo";
import { Plot } from "../topics/plot";
import { PublishForm } from "../topics/publish_form";
import { Transitions } from "../topics/transitions";
import { Types } from "../types";
import type { Context } from "./context";
import { query } from "./tab_panel";

/** How many topics and fields the lists of a plot offer. */
const MAX_OFFERS = 500;

/** A panel to which curves can be added. */
export interface PlotPanel extends Panel {
  add(topic: string, path: string): void;
}

/** A form that chooses a topic and a field in it; `fieldsOf` has the fields of a type, the best ones first. */
function fieldPicker(
  model: Model,
  topic: string,
  verb: string,
  fieldsOf: (types: Types) => readonly string[],
  add: (topic: string, field: string) => void,
): { element: HTMLElement; offerTopics: () => void } {
  const fields = h("datalist", { id: `fields-${Math.random()}` });
  const field = h("input", {
    class: "mono grow",
    list: fields.id,
    placeholder: "field",
    "aria-label": `Field to ${verb.toLowerCase()}`,
    autocomplete: "off",
    spellcheck: "false",
  });
  const topics = h("select", {
    class: "mono",
    "aria-label": `Topic to ${verb.toLowerCase()}`,
    onfocus: () => offerTopics(),
    onpointerdown: () => offerTopics(),
    onchange: () => void offerFields(),
  });
  const offerTopics = (): void => {
    const names = (model.graph.value?.topics ?? [])
      .map(({ name }) => name)
      .filter((name) => name === topic || !isHidden(name))
      .sort();
    if (names.length === topics.options.length) return;
    const chosen = topics.value || topic || names[0] || "";
    replace(topics, ...names.slice(0, MAX_OFFERS).map((value) => h("option", { value }, value)));
    topics.value = chosen;
    void offerFields();
  };
  const offerFields = async (): Promise<void> => {
    const chosen = model.graph.value?.topics.find(({ name }) => name === topics.value);
    if (chosen === undefined || chosen.type === "") return;
    const types = new Types(await model.typedefs(chosen.type).catch(() => []));
    if (topics.value !== chosen.name) return;
    const all = [...new Set(fieldsOf(types))];
    replace(fields, ...all.slice(0, MAX_OFFERS).map((value) => h("option", { value })));
    field.value = all[0] ?? "";
  };
  const submit = (event: Event): void => {
    event.preventDefault();
    if (topics.value !== "" && field.value.trim() !== "") add(topics.value, field.value.trim());
  };
  const element = h(
    "form",
    { class: "toolbar plot-picker", onsubmit: submit },
    topics,
    field,
    fields,
    h("button", { type: "submit" }, verb),
  );
  return { element, offerTopics };
}

/** A plot that begins with the numbers of a topic, or is empty. */
export function plotPanel(
  { hub, model }: Context,
  topic: string,
  type: string,
  config: Config,
): PlotPanel {
  let state: Config = config;
  let isFirst = true;
  const empty = h("p", { class: "soft" }, "No curves: choose a topic and a number in it.");
  const plot = new Plot(hub, model, () => {
    state = plot.state;
    empty.hidden = Object.keys(state).length > 0;
  });
  const picker = fieldPicker(
    model,
    topic,
    "Plot",
    (types) => [...types.plotPaths(), ...types.numberPaths()],
    (name, path) => plot.add(name, path),
  );
  const begin = async (): Promise<void> => {
    const types = new Types(await model.typedefs(type).catch(() => []));
    for (const path of types.plotPaths()) plot.add(topic, path);
  };
  const element = h("div", { class: "plot-pane" }, picker.element, empty, plot.element);
  dropFields(element, (name, path) => plot.add(name, path));
  return {
    element,
    show() {
      const isNew = isFirst && !("plot" in config);
      plot.show("", isFirst ? query(config) : null);
      isFirst = false;
      picker.offerTopics();
      if (isNew && topic !== "") void begin();
    },
    hide: () => plot.hide(),
    close: () => plot.close(),
    add: (name, path) => plot.add(name, path),
    config: () => state,
  };
}

/** State transitions that begin with the states of a topic, or are empty. */
export function transitionsPanel(
  { hub, model }: Context,
  topic: string,
  type: string,
  config: Config,
): Panel {
  let state: Config = config;
  let isFirst = true;
  const empty = h("p", { class: "soft" }, "No states: choose a topic and a field in it.");
  const transitions = new Transitions(hub, model, () => {
    state = transitions.state;
    empty.hidden = Object.keys(state).length > 0;
  });
  const add = (name: string, path: string): void => void transitions.add(name, path);
  const picker = fieldPicker(model, topic, "Show", (types) => types.statePaths(), add);
  const begin = async (): Promise<void> => {
    const types = new Types(await model.typedefs(type).catch(() => []));
    for (const path of types.statePaths().slice(0, 1)) add(topic, path);
  };
  const element = h("div", { class: "plot-pane" }, picker.element, empty, transitions.element);
  dropFields(element, add);
  return {
    element,
    show() {
      const isNew = isFirst && !("states" in config);
      transitions.show(isFirst ? query(config) : null);
      isFirst = false;
      picker.offerTopics();
      if (isNew && topic !== "") void begin();
    },
    hide: () => transitions.hide(),
    close: () => transitions.close(),
    config: () => state,
  };
}

/** The newest message of a topic. */
export async function echoPanel(
  { hub, model, plot }: Context,
  topic: string,
  type: string,
): Promise<Panel> {
  const typedefs = await model.typedefs(type).catch(() => []);
  const types = typedefs.length > 0 ? new Types(typedefs) : undefined;
  return new Echo(hub, topic, type, types, (path) => plot(topic, path));
}

/** The form of a service. */
export function servicePanel({ hub, model }: Context, name: string, type: string): Panel {
  const page = new ServicePage(hub, model, name, type);
  let stop: (() => void) | undefined;
  return {
    element: page.element,
    show() {
      stop ??= model.graph.watch((graph) => {
        const found = graph?.services.find((service) => service.name === name);
        page.showNode(found?.node, graph !== null);
      });
    },
    hide() {
      stop?.();
      stop = undefined;
    },
  };
}

/** The form of an action, and its goals. */
export function actionPanel({ hub, model, plot }: Context, name: string): Panel {
  const find = () => model.graph.value?.actions.find((action) => action.name === name);
  const info = find() ?? { name, type: "", over_topics: true };
  const page = new ActionPage(hub, model, info, plot);
  let stop: (() => void) | undefined;
  return {
    element: page.element,
    show() {
      stop ??= model.graph.watch((graph) => page.showNode(find()?.node, graph !== null));
    },
    hide() {
      stop?.();
      stop = undefined;
      // Goals that have not ended are followed to their end.
      if (!page.isActive) page.close();
    },
    close: () => page.close(),
  };
}

/** What nodes log. */
export function consolePanel({ model }: Context, config: Config): Panel {
  let state: Config = config;
  let isFirst = true;
  const view = new ConsoleView(model, (next) => {
    state = Object.fromEntries(Object.entries(next).filter(([, value]) => value !== ""));
  });
  return {
    element: view.element,
    show() {
      view.show([], isFirst ? query(config) : null);
      isFirst = false;
    },
    hide: () => view.hide(),
    config: () => state,
  };
}

/** The form to publish on a topic. */
export async function publishPanel(
  { hub, model }: Context,
  topic: string,
  type: string,
): Promise<Panel> {
  const types = new Types(await model.typedefs(type));
  const form = new PublishForm(hub, topic, type, types);
  const element = h("div", { class: "form-pane" }, form.element);
  return { element, show: () => undefined, hide: () => form.close() };
}

export { tabPanel } from "./tab_panel";
