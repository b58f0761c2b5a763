/** Buttons that copy a text to the clipboard. */
import "./copy_button.css";

import { h } from "./dom";

/** How long the button shows the result, in ms. */
const SHOWN = 2000;

/**
 * A button that copies the text that `text` returns.
 *
 * `source` is an element with that text, which is selected if the browser refuses to copy.
 */
export function copyButton(label: string, text: () => string, source?: Element): HTMLButtonElement {
  let timer: number | undefined;
  const button = h("button", { type: "button", class: "copy", "aria-live": "polite" }, label);
  button.addEventListener("click", () => {
    void copy(text(), source).then((result) => {
      button.textContent = result;
      window.clearTimeout(timer);
      timer = window.setTimeout(() => {
        button.textContent = label;
      }, SHOWN);
    });
  });
  return button;
}

/** A text in a box, with a button that copies it. */
export function copyable(text: string, description: string): HTMLElement {
  const code = h("code", {}, text);
  const button = copyButton("Copy", () => text, code);
  button.title = `Copy ${description}`;
  return h(
    "div",
    { class: "copyable" },
    h("pre", { tabindex: 0, role: "group", "aria-label": description }, code),
    button,
  );
}

async function copy(text: string, source: Element | undefined): Promise<string> {
  try {
    // Only pages from https:// or from this machine have a clipboard.
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
  return source === undefined ? "Copying is not allowed" : "Selected: press Ctrl+C";
}
