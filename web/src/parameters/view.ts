/** The Parameters tab: shows all parameters by namespace, to change, add and delete. */
import "./parameters.css";

import { breakable, h, replace, setText } from "../dom";
import { FilterInput } from "../filter";
import { plural } from "../format";
import type { DataSource } from "../source";
import type { MakeView, Place, View } from "../view";
import {
  fromText,
  kind,
  type Namespace,
  type Parameter,
  ParameterServer,
  parameterTree,
  splitParameters,
  toText,
} from "./parameters";

/** Time between two requests that look for changes by others, in ms. */
const INTERVAL = 2000;
/** There are no such requests if all parameters have more characters than this. */
const MAX_POLLED = 100_000;
/** The maximum height of the input for a value, in lines. */
const MAX_LINES = 12;

export const makeView: MakeView = (hub, _model, place) => new ParametersView(hub, place);

class ParametersView implements View {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #place: Place;
  readonly #server: ParameterServer;
  readonly #list = h("div", { class: "parameters-tree scroll panel" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #note = h("p", { class: "soft small", role: "status" });
  readonly #filter = new FilterInput("Filter parameters", () => {
    this.#saveFilter();
    this.#draw();
  });
  readonly #folded = new Set<string>();
  #parameters: [name: string, value: string][] = [];
  #text = "";
  /** The parameter that is being changed and its form, which is kept when the tree is redrawn. */
  #editing: { name: string; form: HTMLFormElement } | null = null;
  #timer: number | undefined;
  #stop: (() => void) | undefined;

  constructor(hub: DataSource, place: Place) {
    this.#place = place;
    this.#hub = hub;
    this.#server = new ParameterServer(hub);
    const refresh = h("button", { type: "button", onclick: () => void this.#refresh() }, "Refresh");
    this.element = h(
      "section",
      { class: "parameters", "aria-label": "Parameters" },
      h("div", { class: "toolbar" }, this.#filter.element, refresh),
      this.#addForm(),
      this.#error,
      this.#list,
      this.#note,
    );
  }

  show(_path: string[], state: URLSearchParams | null): void {
    if (state !== null) {
      this.#filter.text = state.get("filter") ?? "";
      this.#folded.clear();
      for (const name of state.get("folded")?.split(",") ?? []) this.#folded.add(name);
      this.#draw();
    }
    this.#saveFilter();
    this.#stop ??= this.#hub.state.watch((state) => {
      if (state === "open" && this.#editing === null) void this.#refresh();
    });
    this.#schedule();
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    window.clearTimeout(this.#timer);
  }

  /** `?filter=arm&folded=/robot,/camera` */
  #saveFilter(): void {
    this.#place.save({ filter: this.#filter.filter.text, folded: [...this.#folded].join() });
  }

  #addForm(): HTMLElement {
    const name = h("input", { required: true, placeholder: "/robot/speed", spellcheck: "false" });
    const value = h("input", { placeholder: "0.5, true, [1, 2] or text", spellcheck: "false" });
    const form = h(
      "form",
      { class: "toolbar adding" },
      h("label", { class: "field grow" }, "Name", name),
      h("label", { class: "field grow" }, "Value", value),
      h("button", { type: "submit" }, "Add"),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const fullName = name.value.startsWith("/") ? name.value.trim() : `/${name.value.trim()}`;
      void this.#change(() => this.#server.set(fullName, fromText(value.value))).then((done) => {
        if (!done) return;
        form.reset();
        name.focus();
      });
    });
    return h("details", { class: "panel" }, h("summary", {}, "Add a parameter"), form);
  }

  /** Request all parameters and draw them. */
  async #refresh(): Promise<void> {
    await this.#change(async () => undefined);
  }

  /** Change something, then request and draw all parameters; returns whether it succeeded. */
  async #change(change: () => Promise<void>): Promise<boolean> {
    try {
      await change();
      this.#text = await this.#server.all();
      this.#parameters = splitParameters(this.#text);
      this.#error.hidden = true;
    } catch (error) {
      this.#showError(error);
      return false;
    }
    this.#draw();
    return true;
  }

  #showError(error: unknown): void {
    this.#error.hidden = false;
    setText(this.#error, error instanceof Error ? error.message : String(error));
  }

  /** Look for changes by others after some time. */
  #schedule(): void {
    window.clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => {
      void this.#lookForChanges().finally(() => {
        if (this.#stop !== undefined) this.#schedule();
      });
    }, INTERVAL);
  }

  async #lookForChanges(): Promise<void> {
    const idle = this.#editing === null && this.#text.length < MAX_POLLED;
    if (!idle || document.hidden || this.#hub.state.value !== "open") return;
    try {
      const changed = (await this.#server.all()) !== this.#text;
      if (changed && this.#editing === null) await this.#refresh();
    } catch (error) {
      this.#showError(error);
    }
  }

  #draw(): void {
    const root = parameterTree(this.#parameters.filter((each) => this.#filter.filter.shows(each)));
    const { scrollTop } = this.#list;
    const focus = document.activeElement;
    replace(this.#list, this.#namespace(root));
    this.#list.scrollTop = scrollTop;
    // Redrawing removes the focus.
    if (focus instanceof HTMLElement && this.#list.contains(focus)) focus.focus();
    const total = this.#parameters.length;
    setText(
      this.#note,
      root.count === total
        ? plural(total, "parameter")
        : `${root.count} of ${plural(total, "parameter")}`,
    );
  }

  #namespace(space: Namespace): HTMLElement {
    return h(
      "ul",
      {},
      ...space.parameters.map((each) => h("li", { class: "leaf" }, ...this.#parameter(each))),
      ...Array.from(space.children.values(), (each) => h("li", {}, this.#folder(each))),
    );
  }

  #folder(space: Namespace): HTMLElement {
    const remove = this.#deleteButton(
      space.name,
      `${space.name} and ${plural(space.count, "parameter")} in it`,
    );
    const folder = h(
      "details",
      { open: !this.#folded.has(space.name) },
      h(
        "summary",
        {},
        h("code", { class: "ros-name", title: space.name }, ...breakable(`${space.key}/`)),
        h("span", { class: "badge" }, space.count),
      ),
      h("div", { class: "of-space" }, remove),
      this.#namespace(space),
    );
    folder.addEventListener("toggle", () => {
      if (folder.open) this.#folded.delete(space.name);
      else this.#folded.add(space.name);
      if (folder.isConnected) this.#saveFilter();
    });
    return folder;
  }

  #parameter({ name, key, value }: Parameter): HTMLElement[] {
    if (this.#editing?.name === name) {
      return [
        h("code", { class: "key ros-name", title: name }, ...breakable(key)),
        this.#editing.form,
      ];
    }
    const change = h(
      "button",
      {
        type: "button",
        class: "quiet",
        "data-change": name,
        "aria-label": `Change ${name}`,
      },
      "Change",
    );
    change.addEventListener("click", () => this.#edit(name, value));
    return [
      h("code", { class: "key ros-name", title: name }, ...breakable(key)),
      h("code", { class: "value" }, toText(value)),
      h("span", { class: "kind soft small" }, kind(value)),
      h("span", { class: "of-leaf" }, change, this.#deleteButton(name, name)),
    ];
  }

  #edit(name: string, value: string): void {
    const form = valueForm(
      name,
      toText(value),
      (text) => void this.#save(name, text),
      () => this.#finish(name),
    );
    this.#editing = { name, form };
    this.#draw();
    form.querySelector("textarea")?.select();
  }

  async #save(name: string, text: string): Promise<void> {
    const done = await this.#change(() => this.#server.set(name, fromText(text)));
    if (done) this.#finish(name);
  }

  /** Close the form; the focus returns to the button that opened it. */
  #finish(name: string): void {
    this.#editing = null;
    this.#draw();
    for (const button of this.#list.querySelectorAll<HTMLElement>("[data-change]")) {
      if (button.dataset.change === name) button.focus();
    }
  }

  #deleteButton(name: string, description: string): HTMLElement {
    const button = h(
      "button",
      { type: "button", class: "quiet danger", "aria-label": `Delete ${name}` },
      "Delete",
    );
    button.addEventListener("click", () => {
      void confirmed(`Delete ${description}?`, "Delete").then((yes) => {
        if (yes) void this.#change(() => this.#server.remove(name));
      });
    });
    return button;
  }
}

/** A form to change a value: Enter saves, Escape cancels. */
function valueForm(
  name: string,
  value: string,
  save: (text: string) => void,
  cancel: () => void,
): HTMLFormElement {
  const rows = Math.min(MAX_LINES, Math.ceil(value.length / 60) || 1);
  const input = h("textarea", {
    rows,
    value,
    spellcheck: "false",
    "aria-label": `Value of ${name}`,
  });
  const type = h("span", { class: "kind soft small", role: "status" }, kind(fromText(value)));
  const form = h(
    "form",
    { class: "value-form" },
    input,
    type,
    h("button", { type: "submit", class: "primary" }, "Save"),
    h("button", { type: "button", onclick: cancel }, "Cancel"),
  );
  input.addEventListener("input", () => setText(type, kind(fromText(input.value))));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    save(input.value);
  });
  form.addEventListener("keydown", (event) => {
    if (event.key === "Escape") cancel();
    if (event.key === "Enter" && event.target === input && !event.shiftKey && !event.isComposing) {
      event.preventDefault();
      form.requestSubmit();
    }
  });
  return form;
}

/** Ask for confirmation; `yes` is the label of the button that confirms. */
function confirmed(question: string, yes: string): Promise<boolean> {
  const dialog = h(
    "dialog",
    { class: "confirmation", "aria-label": question },
    h(
      "form",
      { method: "dialog" },
      h("p", {}, question),
      h(
        "div",
        { class: "toolbar" },
        h("button", { value: "yes", class: "danger" }, yes),
        h("button", { value: "no", autofocus: true }, "Keep"),
      ),
    ),
  );
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    });
  });
}
