/** One click to copy. */
import "./copy.css";

import { h } from "./dom";

/** How long the button says what it did, in ms. */
const SAID = 2000;

/** A button that copies what `text` gives; `source` shows it, and is selected if all else fails. */
export function copyButton(label: string, text: () => string, source?: Element): HTMLButtonElement {
  let timer: number | undefined;
  const button = h("button", { type: "button", class: "copy", "aria-live": "polite" }, label);
  button.addEventListener("click", () => {
    void copy(text(), source).then((said) => {
      button.textContent = said;
      window.clearTimeout(timer);
      timer = window.setTimeout(() => {
        button.textContent = label;
      }, SAID);
    });
  });
  return button;
}

/** A text in a box, with a button that copies it. */
export function copyable(text: string, what: string): HTMLElement {
  const code = h("code", {}, text);
  const button = copyButton("Copy", () => text, code);
  button.title = `Copy ${what}`;
  return h(
    "div",
    { class: "copyable" },
    h("pre", { tabindex: 0, role: "group", "aria-label": what }, code),
    button,
  );
}

async function copy(text: string, source: Element | undefined): Promise<string> {
  try {
    // Only pages that came over TLS or from this machine have a clipboard.
    await navigator.clipboard.writeText(text);
    return "Copied";
  } catch {
    return copyBySelection(text, source);
  }
}

function copyBySelection(text: string, source: Element | undefined): string {
  const scratch = source ?? document.body.appendChild(h("pre", {}, text));
  const selection = getSelection();
  selection?.selectAllChildren(scratch);
  const copied = document.execCommand("copy");
  if (source === undefined) scratch.remove();
  if (copied) {
    selection?.removeAllRanges();
    return "Copied";
  }
  return source === undefined ? "This browser does not let pages copy" : "Selected: press Ctrl+C";
}
