/** The form of one server of dynamic_reconfigure. */
import "../form/form.css";
import { browsePage } from "../browse";
import { type Child, h, replace, setText } from "../dom";
import type { Message } from "../hub";
import { subscribe } from "../messages/data_client";
import type { DataSource } from "../source";
import {
  type Config,
  type ConfigDescription,
  configOf,
  type Group,
  groupsOf,
  type Parameter,
  parseValue,
  SERVICE,
  statesOf,
  TYPE,
  type Value,
  valuesOf,
} from "./configuration";

/** The steps of a slider over the range of a double. */
const STEPS = 100;
/** A slider for more integers than these could not be moved to each of them. */
const MAX_SLIDER = 100_000;

/** The controls of one parameter. */
interface Control {
  readonly elements: Child[];
  show(value: Value): void;
}

/** Called with a value that the user has chosen. */
type Change = (value: Value) => void;

export class ServerPage {
  readonly element: HTMLElement;
  /** The server's name: that of its node, or a name below it. */
  readonly name: string;
  readonly #hub: DataSource;
  readonly #form = h("form", { class: "reconfigure-form" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #controls = new Map<string, Control>();
  readonly #groups = new Map<number, { group: Group; element: HTMLElement }>();
  /** The changes that the next request sends. */
  #values = new Map<Parameter, Value>();
  /** The groups that are to be opened or closed, by their ids. */
  #states = new Map<number, boolean>();
  #config: Config | null = null;
  #description = "";
  #isCalling = false;
  #stops: (() => void)[] = [];

  constructor(hub: DataSource, name: string, node: string) {
    this.#hub = hub;
    this.name = name;
    replace(this.#form, h("p", { class: "empty" }, `Waiting for ${name}/parameter_descriptions …`));
    this.#form.addEventListener("submit", (event) => event.preventDefault());
    const of = node === "" || node === name ? null : h("p", { class: "soft" }, `Node ${node}`);
    this.element = browsePage(name, "reconfigure", of, this.#error, this.#form);
  }

  open(): void {
    if (this.#stops.length > 0) return;
    const follow = (topic: string, listener: (message: Message) => void) =>
      subscribe(this.#hub, { topic: `${this.name}/${topic}` }, listener, (why) =>
        this.#showError(why),
      );
    this.#stops = [
      follow("parameter_descriptions", (message) => this.#describe(message)),
      follow("parameter_updates", (message) => this.#show(message as unknown as Config)),
    ];
  }

  close(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
  }

  /** Make the form, unless the description is the same as before. */
  #describe(message: Message): void {
    const text = JSON.stringify(message);
    if (text === this.#description) return;
    this.#description = text;
    this.#controls.clear();
    this.#groups.clear();
    const root = groupsOf(message as unknown as ConfigDescription);
    const isEmpty = root === null || (root.parameters.length === 0 && root.groups.length === 0);
    replace(
      this.#form,
      ...(isEmpty
        ? [h("p", { class: "empty" }, "This server has no parameters.")]
        : this.#content(root)),
    );
    if (this.#config !== null) this.#show(this.#config);
  }

  #content(group: Group): HTMLElement[] {
    // The values of such a group are sent together.
    const pending = group.type === "apply" ? new Map<Parameter, Value>() : null;
    const change = (parameter: Parameter, value: Value) => {
      if (pending === null) this.#set(parameter, value);
      else pending.set(parameter, value);
    };
    const rows = group.parameters.map((parameter) => {
      const control = controlOf(parameter, (value) => change(parameter, value));
      this.#controls.set(parameter.name, control);
      return row(parameter, control);
    });
    const apply = () => {
      for (const each of pending ?? []) this.#set(...each);
      pending?.clear();
    };
    return [
      ...rows,
      ...(pending === null ? [] : [h("button", { type: "button", onclick: apply }, "Apply")]),
      ...group.groups.map((each) => this.#group(each)),
    ];
  }

  #group(group: Group): HTMLElement {
    const content = this.#content(group);
    const element =
      group.type === "collapse"
        ? h("details", { class: "group" }, h("summary", {}, group.name), ...content)
        : h("fieldset", { class: "group" }, h("legend", {}, group.name), ...content);
    this.#groups.set(group.id, { group, element });
    if (element instanceof HTMLDetailsElement) {
      element.querySelector("summary")?.addEventListener("click", () => {
        this.#states.set(group.id, !element.open);
        this.#send();
      });
    }
    return element;
  }

  #show(config: Config): void {
    this.#config = config;
    const waiting = new Set([...this.#values.keys()].map(({ name }) => name));
    for (const [name, value] of valuesOf(config)) {
      if (!waiting.has(name)) this.#controls.get(name)?.show(value);
    }
    for (const [id, state] of statesOf(config)) {
      const { group, element } = this.#groups.get(id) ?? {};
      if (element instanceof HTMLDetailsElement) element.open = state;
      else if (element !== undefined && group?.type === "hide") element.hidden = !state;
    }
  }

  #set(parameter: Parameter, value: Value): void {
    this.#values.set(parameter, value);
    this.#send();
  }

  /** Send the newest changes, one request at a time. */
  #send(): void {
    if (this.#isCalling || (this.#values.size === 0 && this.#states.size === 0)) return;
    const states = this.#states;
    const groups = (states.size > 0 && this.#config?.groups) || [];
    const config = configOf(
      this.#values,
      groups.map((group) => ({ ...group, state: states.get(group.id) ?? group.state })),
    );
    this.#values = new Map();
    this.#states = new Map();
    this.#isCalling = true;
    this.#hub
      .call<{ config: Config }>(`${this.name}/${SERVICE}`, TYPE, { config })
      .then(
        (response) => {
          this.#error.hidden = true;
          this.#show(response.config);
        },
        (error: Error) => {
          this.#showError(error.message);
          if (this.#config !== null) this.#show(this.#config);
        },
      )
      .finally(() => {
        this.#isCalling = false;
        this.#send();
      });
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = why === "";
  }
}

function row(parameter: Parameter, control: Control): HTMLElement {
  const { min, max } = parameter;
  const hasRange = parameter.choices.length === 0 && (min !== undefined || max !== undefined);
  const range = hasRange ? `${min ?? "−∞"} to ${max ?? "∞"}` : "";
  const notes = [parameter.description, range].filter((text) => text !== "").join(" · ");
  return h(
    "div",
    { class: "reconfigure-row" },
    h("label", { for: inputId(parameter), class: "mono ros-name" }, parameter.name),
    ...control.elements,
    notes !== "" && h("p", { class: "soft small" }, notes),
  );
}

function inputId({ name }: Parameter): string {
  return `reconfigure-${name}`;
}

function controlOf(parameter: Parameter, change: Change): Control {
  if (parameter.choices.length > 0) return selectOf(parameter, change);
  return parameter.kind === "bool" ? checkbox(parameter, change) : input(parameter, change);
}

function checkbox(parameter: Parameter, change: Change): Control {
  const box = h("input", { type: "checkbox", id: inputId(parameter) });
  box.addEventListener("change", () => change(box.checked));
  return {
    elements: [box],
    show: (value) => {
      box.checked = value === true;
    },
  };
}

function selectOf(parameter: Parameter, change: Change): Control {
  const { choices } = parameter;
  const options = choices.map(({ name, value, description }, index) =>
    h("option", { value: String(index), title: description }, `${name} (${value})`),
  );
  const select = h("select", { id: inputId(parameter) }, ...options);
  select.addEventListener("change", () => {
    const choice = choices[Number(select.value)];
    if (choice !== undefined) change(choice.value);
  });
  const other = h("option", { value: "", disabled: true });
  return {
    elements: [select],
    show: (value) => {
      const index = choices.findIndex((choice) => choice.value === value);
      // Servers may have a value that none of the choices is.
      if (index < 0) {
        setText(other, String(value));
        select.append(other);
      } else {
        other.remove();
      }
      select.value = index < 0 ? "" : String(index);
    },
  };
}

/** A number or text, with a slider if the number has a range. */
function input(parameter: Parameter, change: Change): Control {
  const { kind } = parameter;
  const id = inputId(parameter);
  const problem = h("span", { class: "form-problem", id: `${id}-problem`, "aria-live": "polite" });
  const text = h("input", {
    id,
    autocomplete: "off",
    spellcheck: "false",
    inputmode: kind === "str" ? "text" : "decimal",
    "aria-describedby": problem.id,
  });
  const slider = sliderOf(parameter, (value) => {
    text.value = String(value);
    change(value);
  });
  const clear = () => {
    text.removeAttribute("aria-invalid");
    setText(problem, "");
  };
  text.addEventListener("change", () => {
    try {
      const value = parseValue(parameter, text.value);
      clear();
      text.defaultValue = text.value; // The server's response may replace it.
      change(value);
    } catch (error) {
      text.setAttribute("aria-invalid", "true");
      setText(problem, (error as Error).message);
    }
  });
  return {
    elements: [slider, text, problem],
    show: (value) => {
      if (slider !== null) slider.value = String(value);
      // Text that is being typed stays.
      if (document.activeElement === text && text.value !== text.defaultValue) return;
      clear();
      text.value = String(value);
      text.defaultValue = text.value;
    },
  };
}

function sliderOf(
  { name, kind, min, max }: Parameter,
  change: (value: number) => void,
): HTMLInputElement | null {
  if (kind === "str" || min === undefined || max === undefined || max <= min) return null;
  if (kind === "int" && max - min > MAX_SLIDER) return null;
  const step = kind === "int" ? 1 : (max - min) / STEPS;
  const slider = h("input", { type: "range", min, max, step, "aria-label": `${name}, slider` });
  slider.addEventListener("input", () => change(slider.valueAsNumber));
  return slider;
}
