/** The inputs of a form for single values. */
import { h } from "../dom";
import { type Field, isBytes, kindOf, rangeOf, typeText } from "../types";
import { type Problem, type Reading, textOf } from "./readings";

export interface Control {
  readonly element: HTMLElement;
  /** The value that is written there; what is wrong is told there, and added to the problems. */
  read(problems: Problem[], path: string): unknown;
  write(value: unknown): void;
}

let ids = 0;

function freshId(): string {
  ids += 1;
  return `field-${ids}`;
}

/** A field that unfolds to what is in it. */
export class Folded implements Control {
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
    // What is wrong is to be seen.
    if (problems.length > before) (this.element as HTMLDetailsElement).open = true;
    return value;
  }

  write(value: unknown): void {
    this.#inner.write(value);
  }
}

/** A value that is written as text. */
export class TextControl implements Control {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement | HTMLTextAreaElement;
  readonly #note: HTMLElement;
  readonly #read: (text: string) => Reading;

  constructor(
    field: Field,
    read: (text: string) => Reading,
    hint = "",
    constants: readonly { name: string; value: string }[] = [],
    label = "",
  ) {
    this.#read = read;
    const id = freshId();
    const shared = {
      id,
      class: "form-input",
      placeholder: hint,
      "aria-describedby": `${id}-note`,
      autocomplete: "off",
      spellcheck: "false",
      oninput: () => this.#judge(),
      ...(label === "" ? {} : { "aria-label": label }),
    };
    // A text may have several lines, which an input would lose.
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
        { type: "button", onclick: () => this.write("now"), title: "The moment of publishing" },
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
        : h(
            "div",
            { class: "form-field" },
            h(
              "label",
              { for: id },
              h("span", { class: "form-name" }, field.name),
              " ",
              typeOf(field),
            ),
            h("span", { class: "form-entry" }, this.#input, now, options),
            this.#note,
          );
  }

  read(problems: Problem[], path: string): unknown {
    const reading = this.#judge();
    if ("value" in reading) return reading.value;
    problems.push({ path, text: reading.problem });
    return this.#input.value;
  }

  write(value: unknown): void {
    this.#input.value = textOf(value);
    this.#judge();
  }

  #judge(): Reading {
    const reading = this.#read(this.#input.value);
    const problem = "problem" in reading ? reading.problem : "";
    if (problem === "") this.#input.removeAttribute("aria-invalid");
    else this.#input.setAttribute("aria-invalid", "true");
    this.#note.textContent = problem;
    return reading;
  }
}

export class CheckControl implements Control {
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
        : h(
            "div",
            { class: "form-field" },
            h(
              "label",
              { for: id },
              h("span", { class: "form-name" }, field.name),
              " ",
              typeOf(field),
            ),
            h("span", { class: "form-entry" }, this.#input),
          );
  }

  read(): unknown {
    return this.#input.checked;
  }

  write(value: unknown): void {
    this.#input.checked = value === true;
  }
}

/** A field's type, as it stands beside the name. */
export function typeOf(field: Field): HTMLElement {
  return h("span", { class: "type" }, typeText(field));
}

/** Enter sends the form, as it does in an input; with Shift it is a new line. */
function submitOnEnter(event: KeyboardEvent): void {
  if (event.key !== "Enter" || event.shiftKey || event.isComposing) return;
  event.preventDefault();
  (event.target as HTMLTextAreaElement).form?.requestSubmit();
}
