/** The list of layers: each with a box to show it, its state in words, and its settings. */
import { h, setAttribute, setName, setText } from "../../dom";
import { KeyedRows } from "../../keyed_rows";
import type { Model } from "../../model";
import type { Entry, Level } from "./entry";
import type { Setting, Value } from "./layer";
import type { Scene } from "./scene";

const SIGNS: Readonly<Record<Level, string>> = { off: "", good: "●", warn: "▲", bad: "✕" };

interface Row {
  readonly element: HTMLElement;
  readonly box: HTMLInputElement;
  readonly gear: HTMLButtonElement;
  readonly sign: HTMLElement;
  readonly text: HTMLElement;
  readonly settings: HTMLElement;
}

export class LayerList {
  readonly element: HTMLElement;
  readonly #scene: Scene;
  readonly #model: Model;
  readonly #onChange: () => void;
  readonly #list = h("ul", { class: "scene-layer-list" });
  readonly #rows = new KeyedRows(this.#list, (entry: Entry) => this.#row(entry));
  readonly #empty = h(
    "p",
    { class: "soft small" },
    "Nothing to show yet: publish sensor_msgs/LaserScan, /tf or a map, or start ",
    h("code", {}, "fibws demo robot"),
    ".",
  );

  /** `onChange` is called when somebody has changed a layer. */
  constructor(scene: Scene, model: Model, onChange: () => void) {
    this.#scene = scene;
    this.#model = model;
    this.#onChange = onChange;
    this.element = h(
      "section",
      { class: "scene-layers scroll", "aria-label": "Layers" },
      this.#empty,
      this.#list,
    );
  }

  /** Show the layers and their states. */
  update(): void {
    const now = this.#scene.hub.clock.now();
    const { entries } = this.#scene;
    const places = this.#scene.places();
    this.#empty.hidden = entries.length > 0;
    const published = new Set(
      this.#model.graph.value?.topics
        .filter(({ publishers }) => publishers.length > 0)
        .map(({ name }) => name),
    );
    // What is shown comes first.
    const isOn = (entry: Entry): number => (entry.isOn ? 0 : 1);
    this.#rows.show([...entries].sort((a, b) => isOn(a) - isOn(b)));
    for (const [entry, row] of this.#rows.entries()) {
      const { level, text } = entry.state(now, published.has(entry.topic), places);
      row.box.checked = entry.isOn;
      row.gear.hidden = !entry.isOn;
      if (!entry.isOn) {
        this.#openSettings(row, false);
        // Another layer has other ones.
        row.settings.replaceChildren();
      }
      if (!row.settings.hidden) entry.layer?.updateControls?.(places);
      setAttribute(row.element, "data-level", level);
      setText(row.sign, SIGNS[level]);
      setText(row.text, text);
    }
  }

  /** All states, as lines of text. */
  texts(): string[] {
    return this.#scene.entries
      .filter(({ isOn }) => isOn)
      .map((entry) => `${entry.topic}: ${this.#rows.get(entry)?.text.textContent ?? ""}`);
  }

  #row(entry: Entry): Row {
    const { kind, topic } = entry;
    const box = h("input", {
      type: "checkbox",
      onchange: () => {
        this.#scene.toggle(entry, box.checked);
        this.#onChange();
        this.update();
      },
    });
    const name = h("span", { class: "mono" });
    setName(name, topic);
    const sign = h("span", { class: "scene-sign", "aria-hidden": "true" });
    const text = h("span", { class: "small" });
    const settings = h("div", { class: "scene-settings", hidden: true });
    const gear = h(
      "button",
      {
        type: "button",
        class: "icon quiet",
        "aria-label": `Settings of ${topic}`,
        "aria-expanded": "false",
        onclick: () => {
          if (settings.childElementCount === 0) settings.append(...this.#settings(entry));
          this.#openSettings(row, settings.hidden === true);
          this.update();
        },
      },
      "⚙",
    );
    const element = h(
      "li",
      {},
      h(
        "div",
        { class: "scene-layer" },
        h("label", {}, box, h("span", {}, name, h("span", { class: "soft small" }, kind.label))),
        gear,
      ),
      h("p", { class: "scene-state" }, sign, text),
      settings,
    );
    const row: Row = { element, box, gear, sign, text, settings };
    return row;
  }

  #openSettings({ gear, settings }: Row, isOpen: boolean): void {
    settings.hidden = !isOpen;
    gear.setAttribute("aria-expanded", String(isOpen));
  }

  #settings(entry: Entry): HTMLElement[] {
    const fields = entry.kind.settings.map((setting) =>
      settingField(setting, entry.settings[setting.name] ?? setting.value, (value) => {
        entry.settings[setting.name] = value;
        entry.update();
        this.#onChange();
      }),
    );
    const own = entry.layer?.controls?.();
    return own === undefined ? fields : [...fields, own];
  }
}

/** A field for one setting: its kind is that of the value. */
function settingField(
  { label, options, value: first, min, max, step }: Setting,
  value: Value,
  change: (value: Value) => void,
): HTMLElement {
  if (typeof first === "boolean") {
    const box: HTMLInputElement = h("input", {
      type: "checkbox",
      checked: value === true,
      onchange: () => change(box.checked),
    });
    return h("label", {}, box, label);
  }
  if (options !== undefined) {
    const select: HTMLSelectElement = h(
      "select",
      { value: String(value), onchange: () => change(select.value) },
      ...options.map((option) => h("option", { value: option }, option)),
    );
    return h("label", { class: "field" }, label, select);
  }
  const isNumber = typeof first === "number";
  const type = isNumber ? "number" : first.startsWith("#") ? "color" : "text";
  const input = h("input", {
    type,
    value: String(value),
    min,
    max,
    step: isNumber ? (step ?? "any") : undefined,
    oninput: () => {
      // A number outside of its limits is not used.
      const isValid = input.checkValidity() && !(isNumber && input.value === "");
      input.toggleAttribute("aria-invalid", !isValid);
      if (isValid) change(isNumber ? input.valueAsNumber : input.value);
    },
  });
  return h("label", { class: "field" }, label, input);
}
