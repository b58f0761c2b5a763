/** A form for a message, with inputs for its fields or one JSON text. */
import { h } from "../dom";
import type { Types } from "../types";
import { MessageControl } from "./fields";
import { type Problem, parseJson } from "./parsing";
import { checkMessage, initialMessage, sendable } from "./values";
import "./form.css";

export class MessageForm {
  readonly element: HTMLElement;
  readonly #types: Types;
  readonly #type: string;
  readonly #fields: MessageControl;
  readonly #text: HTMLTextAreaElement;
  readonly #asJson: HTMLInputElement;
  readonly #problems = h("ul", { class: "form-problems", role: "alert" });

  /** `type` is the type of the message, needed if it has no fields. */
  constructor(types: Types, type = types.root) {
    this.#types = types;
    this.#type = type;
    this.#fields = new MessageControl(types, type);
    this.#text = h("textarea", {
      class: "form-json",
      rows: 8,
      hidden: true,
      spellcheck: "false",
      "aria-label": `JSON of ${type}`,
      onkeydown: (event: KeyboardEvent) => {
        if (event.key === "Enter" && (event.ctrlKey || event.metaKey))
          this.#text.form?.requestSubmit();
      },
    });
    this.#asJson = h("input", { type: "checkbox", onchange: () => this.#toggle() });
    this.element = h(
      "div",
      { class: "form" },
      h("label", { class: "form-toggle" }, this.#asJson, " as JSON"),
      this.#fields.element,
      this.#text,
      this.#problems,
    );
  }

  /** The message to send; `undefined` if the form shows problems. */
  read(): Record<string, unknown> | undefined {
    const problems: Problem[] = [];
    const value = this.#asJson.checked ? this.#readText(problems) : this.#fields.read(problems, "");
    this.#showProblems(problems);
    return problems.length === 0 ? sendable(this.#types, this.#type, value) : undefined;
  }

  #readText(problems: Problem[]): unknown {
    try {
      return checkMessage(this.#types, this.#type, parseJson(this.#text.value), problems);
    } catch (error) {
      problems.push({ path: "", text: `Invalid JSON: ${(error as Error).message}` });
      return undefined;
    }
  }

  /** Switch between fields and JSON; invalid JSON must be corrected first. */
  #toggle(): void {
    const problems: Problem[] = [];
    if (this.#asJson.checked) {
      const value = this.#fields.read(problems, "");
      this.#text.value = JSON.stringify(value ?? initialMessage(this.#types, this.#type), null, 2);
      this.#text.rows = Math.min(20, this.#text.value.split("\n").length + 1);
    } else {
      const value = this.#readText(problems);
      if (problems.length > 0) this.#asJson.checked = true;
      else this.#fields.write(value);
    }
    this.#showProblems(problems);
    this.#text.hidden = !this.#asJson.checked;
    this.#fields.element.hidden = this.#asJson.checked;
  }

  #showProblems(problems: readonly Problem[]): void {
    // Only the first few.
    this.#problems.replaceChildren(
      ...problems
        .slice(0, 5)
        .map(({ path, text }) =>
          h("li", {}, path === "" ? null : h("code", {}, path), path === "" ? text : `: ${text}`),
        ),
    );
  }
}
