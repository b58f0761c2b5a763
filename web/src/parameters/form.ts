/** A parameter's value, to be changed in place. */
import { h, say } from "../dom";
import { kind, meant } from "./value";

/** Lines that one sees at once. */
const MOST_LINES = 12;

/** A form for a new value in place of `value`: Enter saves, Escape gives up. */
export function valueForm(
  name: string,
  value: string,
  save: (value: string) => void,
  giveUp: () => void,
): HTMLFormElement {
  const rows = Math.min(MOST_LINES, Math.ceil(value.length / 60) || 1);
  const input = h("textarea", {
    rows,
    value,
    spellcheck: "false",
    "aria-label": `Value of ${name}`,
  });
  const type = h("span", { class: "kind soft small", role: "status" }, kind(meant(value)));
  const form = h(
    "form",
    { class: "value-form" },
    input,
    type,
    h("button", { type: "submit", class: "primary" }, "Save"),
    h("button", { type: "button", onclick: giveUp }, "Cancel"),
  );
  input.addEventListener("input", () => say(type, kind(meant(input.value))));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    save(input.value);
  });
  form.addEventListener("keydown", (event) => {
    if (event.key === "Escape") giveUp();
    if (event.key === "Enter" && event.target === input && !event.shiftKey && !event.isComposing) {
      event.preventDefault();
      form.requestSubmit();
    }
  });
  return form;
}
