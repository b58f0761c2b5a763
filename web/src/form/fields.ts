/** The fields of a message and the elements of arrays, and so on inwards. */
import { h, replace } from "../dom";
import { type Field, isBytes, kindOf, own, type Types } from "../types";
import { CheckControl, type Control, Folded, TextControl, typeOf } from "./controls";
import {
  lengthProblem,
  objectOf,
  type Problem,
  parseJson,
  type Reading,
  readBytes,
  readText,
} from "./readings";
import { checkField, initial, initialElement } from "./values";

/** Elements up to which a list has inputs of its own for each. */
const LONG = 64;

/** The fields of a message, one below the other. */
export class MessageControl implements Control {
  readonly element: HTMLElement;
  readonly #controls: [Field, Control][];
  readonly #types: Types;
  readonly #type: string;

  constructor(types: Types, type: string, depth = 0) {
    this.#types = types;
    this.#type = type;
    this.#controls = types.fields(type).map((field) => {
      const control = fieldControl(types, field, type, depth);
      control.write(initial(types, field, type));
      return [field, control];
    });
    this.element = h(
      "div",
      { class: "form-fields" },
      ...(this.#controls.length === 0
        ? [h("p", { class: "soft" }, `${type} has no fields.`)]
        : this.#controls.map(([, control]) => control.element)),
    );
  }

  read(problems: Problem[], path: string): unknown {
    return objectOf(
      this.#controls.map(([field, control]) => [
        field.name,
        control.read(problems, path === "" ? field.name : `${path}.${field.name}`),
      ]),
    );
  }

  write(value: unknown): void {
    for (const [field, control] of this.#controls) {
      control.write(own(value, field.name) ?? initial(this.#types, field, this.#type));
    }
  }
}

/** One field with its name and type. */
function fieldControl(types: Types, field: Field, message: string, depth: number): Control {
  if (isBytes(field)) {
    return new TextControl(field, (text) => readBytes(field, text), "base64, or [1, 2, 3]");
  }
  if (field.array >= 0) return new ListControl(types, field, message, depth);
  if (kindOf(field.type) === "message") {
    return new Folded(field, new MessageControl(types, field.type, depth + 1), depth < 2);
  }
  if (field.type === "bool") return new CheckControl(field);
  return new TextControl(
    field,
    (text) => readText(field.type, text),
    "",
    types.constants(message, field.type),
  );
}

/** An array: an input for each element, or one of JSON text if there are many. */
class ListControl implements Control {
  readonly element: HTMLDetailsElement;
  readonly #types: Types;
  readonly #field: Field;
  readonly #message: string;
  readonly #depth: number;
  readonly #body = h("div", { class: "form-list" });
  readonly #count = h("span", { class: "soft" });
  readonly #add: HTMLButtonElement;
  readonly #note = h("p", { class: "form-problem", "aria-live": "polite" });
  #elements: Control[] = [];
  /** The one input of a long list. */
  #text: Control | undefined;

  constructor(types: Types, field: Field, message: string, depth: number) {
    this.#types = types;
    this.#field = field;
    this.#message = message;
    this.#depth = depth;
    this.#add = h(
      "button",
      {
        type: "button",
        "aria-label": `Add an element to ${field.name}`,
        onclick: () => this.#append(),
      },
      "Add",
    );
    this.element = h(
      "details",
      { class: "form-nested" },
      h(
        "summary",
        {},
        h("span", { class: "form-name" }, field.name),
        " ",
        typeOf(field),
        " ",
        this.#count,
      ),
      this.#body,
      field.array === 0 && this.#add,
      this.#note,
    );
    if (kindOf(field.type) !== "message") this.#body.classList.add("form-cells");
  }

  read(problems: Problem[], path: string): unknown {
    const before = problems.length;
    const value =
      this.#text === undefined
        ? this.#elements.map((control, at) => control.read(problems, `${path}[${at}]`))
        : this.#text.read(problems, path);
    const length =
      this.#text === undefined ? lengthProblem(this.#field, this.#elements.length) : undefined;
    if (length !== undefined) problems.push({ path, text: length });
    this.#note.textContent = length ?? "";
    if (problems.length > before) this.element.open = true;
    return value;
  }

  write(value: unknown): void {
    const list: unknown[] = Array.isArray(value) ? value : [];
    this.#elements = [];
    this.#text = undefined;
    if (list.length > LONG) {
      this.#text = new TextControl(
        { ...this.#field, type: "string" },
        (text) => this.#readList(text),
        "[1, 2, 3]",
        [],
        this.#field.name,
      );
      this.#text.write(list);
      replace(this.#body, this.#text.element);
    } else {
      this.#body.replaceChildren();
      for (const each of list) this.#append().write(each);
    }
    this.#add.hidden = this.#text !== undefined;
    this.element.open = list.length > 0 && list.length <= 8;
    this.#tell(list.length);
  }

  #readList(text: string): Reading {
    let value: unknown;
    try {
      value = parseJson(text);
    } catch (error) {
      return { problem: `no JSON: ${(error as Error).message}` };
    }
    const problems: Problem[] = [];
    const checked = checkField(this.#types, this.#field, value, problems, "");
    const first = problems[0];
    return first === undefined
      ? { value: checked }
      : { problem: `${first.path} ${first.text}`.trim() };
  }

  #append(): Control {
    const control = this.#element(this.#elements.length);
    control.write(initialElement(this.#types, this.#field, this.#message));
    this.#elements.push(control);
    const row = h("div", { class: "form-element" }, control.element);
    if (this.#field.array === 0) {
      const remove = (): void => {
        this.#elements.splice(this.#elements.indexOf(control), 1);
        row.remove();
        this.#tell(this.#elements.length);
        this.#add.focus();
      };
      row.append(
        h(
          "button",
          {
            type: "button",
            class: "form-remove",
            "aria-label": `Remove this element of ${this.#field.name}`,
            onclick: remove,
          },
          "×",
        ),
      );
    }
    this.#body.append(row);
    this.#tell(this.#elements.length);
    return control;
  }

  #element(at: number): Control {
    const field = { name: `[${at}]`, type: this.#field.type, array: -1 };
    const label = `${this.#field.name}[${at}]`;
    switch (kindOf(field.type)) {
      case "message":
        return new Folded(
          field,
          new MessageControl(this.#types, field.type, this.#depth + 1),
          true,
        );
      case "bool":
        return new CheckControl(field, label);
      default:
        return new TextControl(
          field,
          (text) => readText(field.type, text),
          "",
          this.#types.constants(this.#message, field.type),
          label,
        );
    }
  }

  #tell(length: number): void {
    this.#count.textContent = length === 0 ? "empty" : String(length);
  }
}
