/** The inputs of a form: one control for each value, nested as the message is. */
import { type Child, h, replace } from "../dom";
import { type Field, isBytes, kindOf, own, rangeOf, type Types, typeText } from "../types";
import {
  lengthProblem,
  objectOf,
  type Problem,
  parseBytes,
  parseJson,
  parseText,
  type Result,
  textOf,
} from "./parsing";
import { checkField, initial, initialElement } from "./values";

/** Longer arrays are edited as one JSON text, instead of an input for each element. */
const MAX_INPUTS = 64;

interface Control {
  readonly element: HTMLElement;
  /** The entered value. Problems are shown in the control and added to the list. */
  read(problems: Problem[], path: string): unknown;
  write(value: unknown): void;
}

let ids = 0;

function freshId(): string {
  ids += 1;
  return `field-${ids}`;
}

/** A field that can be opened, with a control for its content. */
class FoldedControl implements Control {
  readonly element: HTMLElement;
  readonly #inner: Control;

  constructor(field: Field, inner: Control, open: boolean) {
    this.#inner = inner;
    this.element = h(
      "details",
      { class: "form-nested", open },
      h("summary", {}, h("span", { class: "form-name" }, field.name), " ", typeOf(field)),
      inner.element,
    );
  }

  read(problems: Problem[], path: string): unknown {
    const before = problems.length;
    const value = this.#inner.read(problems, path);
    // Problems must be visible.
    if (problems.length > before) (this.element as HTMLDetailsElement).open = true;
    return value;
  }

  write(value: unknown): void {
    this.#inner.write(value);
  }
}

/** A value that is entered as text. */
class TextControl implements Control {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement | HTMLTextAreaElement;
  readonly #note: HTMLElement;
  readonly #parse: (text: string) => Result;

  constructor(
    field: Field,
    parse: (text: string) => Result,
    hint = "",
    constants: readonly { name: string; value: string }[] = [],
    label = "",
  ) {
    this.#parse = parse;
    const id = freshId();
    const shared = {
      id,
      class: "form-input",
      placeholder: hint,
      "aria-describedby": `${id}-note`,
      autocomplete: "off",
      spellcheck: "false",
      oninput: () => this.#validate(),
      ...(label === "" ? {} : { "aria-label": label }),
    };
    // Strings may have several lines.
    if (kindOf(field.type) === "string" || isBytes(field)) {
      this.#input = h("textarea", { ...shared, rows: 1, onkeydown: submitOnEnter });
    } else {
      const list = constants.length > 0 ? `${id}-constants` : undefined;
      this.#input = h("input", {
        ...shared,
        list,
        type: "text",
        inputmode: rangeOf(field.type) === undefined ? "text" : "numeric",
      });
    }
    this.#note = h("span", { class: "form-problem", id: `${id}-note`, "aria-live": "polite" });
    const now =
      field.type === "time" &&
      h(
        "button",
        { type: "button", onclick: () => this.write("now"), title: "The time of publishing" },
        "Now",
      );
    const options =
      constants.length > 0 &&
      h(
        "datalist",
        { id: `${id}-constants` },
        ...constants.map(({ name, value }) =>
          h("option", { value, label: value === name ? undefined : name }, name),
        ),
      );
    this.element =
      label !== ""
        ? h("span", { class: "form-cell" }, this.#input, this.#note)
        : labelled(field, id, [this.#input, now, options], this.#note);
  }

  read(problems: Problem[], path: string): unknown {
    const result = this.#validate();
    if ("value" in result) return result.value;
    problems.push({ path, text: result.problem });
    return this.#input.value;
  }

  write(value: unknown): void {
    this.#input.value = textOf(value);
    this.#validate();
  }

  #validate(): Result {
    const result = this.#parse(this.#input.value);
    const problem = "problem" in result ? result.problem : "";
    if (problem === "") this.#input.removeAttribute("aria-invalid");
    else this.#input.setAttribute("aria-invalid", "true");
    this.#note.textContent = problem;
    return result;
  }
}

class CheckControl implements Control {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement;

  constructor(field: Field, label = "") {
    const id = freshId();
    this.#input = h("input", {
      id,
      type: "checkbox",
      ...(label === "" ? {} : { "aria-label": label }),
    });
    this.element =
      label !== ""
        ? h("span", { class: "form-cell" }, this.#input)
        : labelled(field, id, [this.#input]);
  }

  read(): unknown {
    return this.#input.checked;
  }

  write(value: unknown): void {
    this.#input.checked = value === true;
  }
}

/** A control in its own row, with the name and the type of the field as its label. */
function labelled(field: Field, id: string, entry: Child[], note?: HTMLElement): HTMLElement {
  const name = h("span", { class: "form-name" }, field.name);
  return h(
    "div",
    { class: "form-field" },
    h("label", { for: id }, name, " ", typeOf(field)),
    h("span", { class: "form-entry" }, ...entry),
    note,
  );
}

/** The type of a field, shown beside its name. */
function typeOf(field: Field): HTMLElement {
  return h("span", { class: "type" }, typeText(field));
}

/** Enter submits the form, as in an input; with Shift it inserts a new line. */
function submitOnEnter(event: KeyboardEvent): void {
  if (event.key !== "Enter" || event.shiftKey || event.isComposing) return;
  event.preventDefault();
  (event.target as HTMLTextAreaElement).form?.requestSubmit();
}

/** The controls of all fields of a message. */
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

/** The control of a field, with its name and type. */
function fieldControl(types: Types, field: Field, message: string, depth: number): Control {
  if (isBytes(field)) {
    return new TextControl(field, (text) => parseBytes(field, text), "base64, or [1, 2, 3]");
  }
  if (field.array >= 0) return new ListControl(types, field, message, depth);
  if (kindOf(field.type) === "message") {
    return new FoldedControl(field, new MessageControl(types, field.type, depth + 1), depth < 2);
  }
  if (field.type === "bool") return new CheckControl(field);
  return new TextControl(
    field,
    (text) => parseText(field.type, text),
    "",
    types.constants(message, field.type),
  );
}

/** An array: an input for each element, or one JSON text if there are many. */
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
  /** The input of a long array. */
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
    if (list.length > MAX_INPUTS) {
      this.#text = new TextControl(
        { ...this.#field, type: "string" },
        (text) => this.#parseList(text),
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
    this.#showCount(list.length);
  }

  #parseList(text: string): Result {
    let value: unknown;
    try {
      value = parseJson(text);
    } catch (error) {
      return { problem: `invalid JSON: ${(error as Error).message}` };
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
        this.#showCount(this.#elements.length);
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
    this.#showCount(this.#elements.length);
    return control;
  }

  #element(at: number): Control {
    const field = { name: `[${at}]`, type: this.#field.type, array: -1 };
    const label = `${this.#field.name}[${at}]`;
    switch (kindOf(field.type)) {
      case "message":
        return new FoldedControl(
          field,
          new MessageControl(this.#types, field.type, this.#depth + 1),
          true,
        );
      case "bool":
        return new CheckControl(field, label);
      default:
        return new TextControl(
          field,
          (text) => parseText(field.type, text),
          "",
          this.#types.constants(this.#message, field.type),
          label,
        );
    }
  }

  #showCount(length: number): void {
    this.#count.textContent = length === 0 ? "empty" : String(length);
  }
}
