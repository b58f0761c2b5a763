/** All parameters: by namespace, to be read, changed, added and deleted. */
import "./parameters.css";

import { h, replace, say } from "../dom";
import { plural } from "../format";
import type { Hub } from "../hub";
import type { MakeView, View } from "../view";
import { confirmed } from "./confirmation";
import { valueForm } from "./form";
import { ParameterServer } from "./server";
import { type Leaf, type Namespace, tree } from "./tree";
import { kind, meant, written } from "./value";

/** Time between two looks at whether others changed anything, in ms. */
const INTERVAL = 2000;
/** Characters of all parameters up to which such a look is cheap. */
const CHEAP = 100_000;

export const makeView: MakeView = (hub) => new ParametersView(hub);

class ParametersView implements View {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #server: ParameterServer;
  readonly #list = h("div", { class: "parameters-tree scroll panel" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #note = h("p", { class: "soft small", role: "status" });
  readonly #filter = h("input", {
    type: "search",
    class: "grow",
    "aria-label": "Filter",
    placeholder: "part of a name",
  });
  readonly #folded = new Set<string>();
  #parameters: [name: string, value: string][] = [];
  #text = "";
  /** The parameter that is being changed, and the form for that: it outlives what is drawn. */
  #editing: { name: string; form: HTMLFormElement } | null = null;
  #timer: number | undefined;
  #stop: (() => void) | undefined;

  constructor(hub: Hub) {
    this.#hub = hub;
    this.#server = new ParameterServer(hub);
    this.#filter.addEventListener("input", () => this.#draw());
    const refresh = h("button", { type: "button", onclick: () => void this.#refresh() }, "Refresh");
    this.element = h(
      "section",
      { class: "parameters", "aria-label": "Parameters" },
      h("div", { class: "toolbar" }, this.#filter, refresh),
      this.#adding(),
      this.#error,
      this.#list,
      this.#note,
    );
  }

  show(): void {
    this.#stop ??= this.#hub.state.watch((state) => {
      if (state === "open" && this.#editing === null) void this.#refresh();
    });
    this.#wait();
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    window.clearTimeout(this.#timer);
  }

  #adding(): HTMLElement {
    const name = h("input", { required: true, placeholder: "/robot/speed", spellcheck: "false" });
    const value = h("input", { placeholder: "0.5, true, [1, 2] or a text", spellcheck: "false" });
    const form = h(
      "form",
      { class: "toolbar adding" },
      h("label", { class: "field grow" }, "Name", name),
      h("label", { class: "field grow" }, "Value", value),
      h("button", { type: "submit" }, "Add"),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const whole = name.value.startsWith("/") ? name.value.trim() : `/${name.value.trim()}`;
      void this.#change(() => this.#server.set(whole, meant(value.value))).then((done) => {
        if (!done) return;
        form.reset();
        name.focus();
      });
    });
    return h("details", { class: "panel" }, h("summary", {}, "Add a parameter"), form);
  }

  /** Ask for all, and draw them. */
  async #refresh(): Promise<void> {
    await this.#change(async () => undefined);
  }

  /** Do something to the parameters, and then show them; tells whether it could be done. */
  async #change(what: () => Promise<void>): Promise<boolean> {
    try {
      await what();
      this.#text = await this.#server.text();
      this.#parameters = await this.#server.all();
      this.#error.hidden = true;
    } catch (error) {
      this.#fail(error);
      return false;
    }
    this.#draw();
    return true;
  }

  #fail(error: unknown): void {
    this.#error.hidden = false;
    say(this.#error, error instanceof Error ? error.message : String(error));
  }

  /** See to it that what others change is seen here, too. */
  #wait(): void {
    window.clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => {
      void this.#look().finally(() => {
        if (this.#stop !== undefined) this.#wait();
      });
    }, INTERVAL);
  }

  async #look(): Promise<void> {
    const idle = this.#editing === null && this.#text.length < CHEAP;
    if (!idle || document.hidden || this.#hub.state.value !== "open") return;
    try {
      const changed = (await this.#server.text()) !== this.#text;
      if (changed && this.#editing === null) await this.#refresh();
    } catch (error) {
      this.#fail(error);
    }
  }

  #draw(): void {
    const part = this.#filter.value.trim().toLowerCase();
    const root = tree(this.#parameters.filter(([name]) => name.toLowerCase().includes(part)));
    const { scrollTop } = this.#list;
    const focus = document.activeElement;
    replace(this.#list, this.#space(root));
    this.#list.scrollTop = scrollTop;
    // To be moved is to lose it.
    if (focus instanceof HTMLElement && this.#list.contains(focus)) focus.focus();
    const all = this.#parameters.length;
    say(
      this.#note,
      root.count === all
        ? plural(all, "parameter")
        : `${root.count} of ${plural(all, "parameter")}`,
    );
  }

  #space(space: Namespace): HTMLElement {
    return h(
      "ul",
      {},
      ...space.leaves.map((leaf) => h("li", { class: "leaf" }, ...this.#leaf(leaf))),
      ...Array.from(space.spaces.values(), (below) => h("li", {}, this.#folder(below))),
    );
  }

  #folder(space: Namespace): HTMLElement {
    const remove = this.#removal(
      space.name,
      `${space.name} and ${plural(space.count, "parameter")} in it`,
    );
    const folder = h(
      "details",
      { open: !this.#folded.has(space.name) },
      h("summary", {}, h("code", {}, `${space.key}/`), h("span", { class: "badge" }, space.count)),
      h("div", { class: "of-space" }, remove),
      this.#space(space),
    );
    folder.addEventListener("toggle", () => {
      if (folder.open) this.#folded.delete(space.name);
      else this.#folded.add(space.name);
    });
    return folder;
  }

  #leaf(leaf: Leaf): HTMLElement[] {
    if (this.#editing?.name === leaf.name) {
      return [h("code", { class: "key" }, leaf.key), this.#editing.form];
    }
    const change = h(
      "button",
      {
        type: "button",
        class: "quiet",
        "data-change": leaf.name,
        "aria-label": `Change ${leaf.name}`,
      },
      "Change",
    );
    change.addEventListener("click", () => this.#edit(leaf));
    return [
      h("code", { class: "key", title: leaf.name }, leaf.key),
      h("code", { class: "value" }, written(leaf.value)),
      h("span", { class: "kind soft small" }, kind(leaf.value)),
      h("span", { class: "of-leaf" }, change, this.#removal(leaf.name, leaf.name)),
    ];
  }

  #edit(leaf: Leaf): void {
    const form = valueForm(
      leaf.name,
      written(leaf.value),
      (value) => void this.#save(leaf.name, value),
      () => this.#finish(leaf.name),
    );
    this.#editing = { name: leaf.name, form };
    this.#draw();
    form.querySelector("textarea")?.select();
  }

  async #save(name: string, value: string): Promise<void> {
    const done = await this.#change(() => this.#server.set(name, meant(value)));
    if (done) this.#finish(name);
  }

  /** Whoever ends finds the focus where it began. */
  #finish(name: string): void {
    this.#editing = null;
    this.#draw();
    for (const button of this.#list.querySelectorAll<HTMLElement>("[data-change]")) {
      if (button.dataset.change === name) button.focus();
    }
  }

  #removal(name: string, what: string): HTMLElement {
    const button = h(
      "button",
      { type: "button", class: "quiet danger", "aria-label": `Delete ${name}` },
      "Delete",
    );
    button.addEventListener("click", () => {
      void confirmed(`Delete ${what}?`, "Delete").then((sure) => {
        if (sure) void this.#change(() => this.#server.remove(name));
      });
    });
    return button;
  }
}
