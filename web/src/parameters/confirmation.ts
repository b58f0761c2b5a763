/** To be asked before something is gone. */
import { h } from "../dom";

/** Ask, and give whether the answer was `yes`, which is the word on the button. */
export function confirmed(question: string, yes: string): Promise<boolean> {
  const dialog = h(
    "dialog",
    { class: "confirmation", "aria-label": question },
    h(
      "form",
      { method: "dialog" },
      h("p", {}, question),
      h(
        "div",
        { class: "toolbar" },
        h("button", { value: "yes", class: "danger" }, yes),
        h("button", { value: "no", autofocus: true }, "Keep"),
      ),
    ),
  );
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    });
  });
}
