/** The tools above the panels: which layout is shown, and saving, exporting and importing it. */
import { h, replace, setText } from "../dom";
import { download } from "../download";
import { route } from "../view";
import { fromFile, type Layout, LayoutError, toFile } from "./layout";
import type { LayoutStore } from "./store";

/** The names that a parameter of the hub may have. */
const NAME = "[A-Za-z][A-Za-z0-9_]{0,63}";
/** The largest file to import, in bytes. */
const MAX_FILE = 1_000_000;

/** What the tools change. */
export interface Dashboard {
  /** The layout that is shown, with the settings of its panels. */
  readonly layout: Layout | null;
  readonly canUndo: boolean;
  addPanel(): void;
  makeAuto(): void;
  undo(): void;
  /** Show a layout that replaces the one before, which can be undone. */
  change(layout: Layout | null): void;
  /** Show the shared layout of the same name as it is on the hub. */
  revert(): void;
  /** Show why something failed; an empty text hides the last reason. */
  showError(why: string): void;
}

export class Tools {
  readonly element: HTMLElement;
  readonly #store: LayoutStore;
  readonly #dashboard: Dashboard;
  readonly #layouts: HTMLSelectElement = h("select", {
    "aria-label": "Layout",
    onchange: () => go(this.#layouts.value),
  });
  readonly #add: HTMLButtonElement;
  readonly #undo: HTMLButtonElement;
  readonly #more = h("details", { class: "dashboard-more" });
  readonly #status = h("span", { class: "soft small", role: "status" });
  readonly #file = h("input", {
    type: "file",
    accept: ".json,application/json",
    hidden: true,
    "aria-label": "File with a layout",
    onchange: () => void this.#import(),
  });

  constructor(store: LayoutStore, dashboard: Dashboard) {
    this.#store = store;
    this.#dashboard = dashboard;
    const button = (label: string, onclick: () => void) =>
      h("button", { type: "button", onclick }, label);
    this.#add = button("Add panel", () => dashboard.addPanel());
    this.#undo = button("Undo", () => dashboard.undo());
    this.element = h(
      "div",
      { class: "toolbar" },
      this.#layouts,
      this.#add,
      button("Auto", () => dashboard.makeAuto()),
      this.#undo,
      button("Save …", () => this.#askName()),
      this.#more,
      this.#status,
      this.#file,
    );
  }

  /** Another layout is shown, or it has changed. */
  update(): void {
    const store = this.#store;
    const { name } = store;
    const ownNames = store.ownNames;
    const isOwn = ownNames.includes(name);
    if (name !== "" && !store.has(name)) ownNames.push(name);
    const group = (label: string, names: string[]) =>
      names.length === 0
        ? null
        : h("optgroup", { label }, ...names.map((value) => h("option", { value }, value)));
    replace(
      this.#layouts,
      h("option", { value: "" }, "Without a name"),
      group("In this browser", ownNames),
      group("On the hub", store.sharedNames),
    );
    this.#layouts.value = name;
    this.#undo.disabled = !this.#dashboard.canUndo;
    const isChanged = store.isShared() && store.isChanged(this.#dashboard.layout);
    const meanwhile = store.isOutdated ? ", and on the hub meanwhile" : "";
    setText(this.#status, isChanged ? `changed here${meanwhile}` : "");
    const item = (label: string, work: () => void) =>
      h("button", { type: "button", class: "quiet", onclick: () => this.#do(work) }, label);
    replace(
      this.#more,
      h("summary", { class: "button" }, "More"),
      h(
        "div",
        { class: "panel" },
        isChanged ? item("Load from the hub again", () => this.#dashboard.revert()) : null,
        item("Export as a file", () => this.#export()),
        item("Import a file …", () => this.#file.click()),
        isOwn ? item(`Delete “${name}”`, () => void this.#delete(name)) : null,
        store.isShared()
          ? item(`Delete “${name}” for everybody`, () => void this.#delete(name))
          : null,
      ),
    );
  }

  /** Put the focus on the button that adds a panel. */
  focus(): void {
    this.#add.focus();
  }

  /** Close the menu; returns whether it was open. */
  closeMenu(): boolean {
    const { open } = this.#more;
    this.#more.open = false;
    return open;
  }

  #do(work: () => void): void {
    this.closeMenu();
    this.#more.querySelector("summary")?.focus();
    work();
  }

  #askName(): void {
    const store = this.#store;
    const name = h("input", {
      value: store.name,
      required: true,
      pattern: NAME,
      title: "A letter, then letters, digits and underscores",
      autocomplete: "off",
      spellcheck: "false",
    });
    const isForAll = h("input", { type: "checkbox", checked: store.isShared() });
    const note = h("p", { class: "soft small", role: "status" });
    const update = (): void => {
      const { value } = name;
      const notes = [
        isForAll.checked ? `The hub keeps it in the parameter /fibws/layouts/${value}.` : "",
        store.has(value) && value !== store.name ? `This replaces “${value}”.` : "",
      ];
      setText(note, notes.join(" ").trim());
    };
    const dialog: HTMLDialogElement = h(
      "dialog",
      { "aria-label": "Save the layout", onclose: () => dialog.remove() },
      h(
        "form",
        {
          class: "dashboard-save",
          oninput: update,
          onsubmit: (event: Event) => {
            event.preventDefault();
            dialog.close();
            void this.#save(name.value, isForAll.checked);
          },
        },
        h("label", { class: "field" }, "Name", name),
        h("label", {}, isForAll, "For everybody at this hub"),
        note,
        h(
          "div",
          { class: "toolbar" },
          h("button", { type: "submit", class: "primary" }, "Save"),
          h("button", { type: "button", onclick: () => dialog.close() }, "Cancel"),
        ),
      ),
    );
    update();
    this.element.append(dialog);
    dialog.showModal();
  }

  async #save(name: string, isForAll: boolean): Promise<void> {
    try {
      await this.#store.save(name, this.#dashboard.layout, isForAll);
    } catch (error) {
      this.#dashboard.showError(`The hub did not save the layout: ${(error as Error).message}`);
      return;
    }
    this.#dashboard.showError("");
    if (name === this.#store.name) this.update();
    else go(name);
  }

  async #delete(name: string): Promise<void> {
    try {
      await this.#store.remove(name);
    } catch (error) {
      this.#dashboard.showError(`The hub did not delete the layout: ${(error as Error).message}`);
      return;
    }
    go("");
  }

  #export(): void {
    const name = this.#store.name || "dashboard";
    const text = JSON.stringify(JSON.parse(toFile(name, this.#dashboard.layout)), null, 2);
    download(`${name}.json`, new Blob([text], { type: "application/json" }));
  }

  async #import(): Promise<void> {
    const file = this.#file.files?.[0];
    if (file === undefined) return;
    try {
      if (file.size > MAX_FILE) throw new LayoutError(`larger than ${MAX_FILE} bytes`);
      this.#dashboard.change(fromFile(await file.text()).layout);
    } catch (error) {
      this.#dashboard.showError(`${file.name} was not imported: ${(error as Error).message}`);
    } finally {
      this.#file.value = "";
    }
  }
}

/** Show the layout with a name. */
function go(name: string): void {
  location.hash = name === "" ? route("dashboard") : route("dashboard", name);
}
