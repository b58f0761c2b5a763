/** Pieces of the tabs that have a list and, beside it, a page about the chosen element. */
import "./browse.css";

import { breakable, type Child, h } from "./dom";
import { route } from "./view";

/** The page about one element of a tab, with a link to close it. */
export function browsePage(
  name: string,
  tab: "topics" | "services" | "actions" | "reconfigure",
  ...children: Child[]
): HTMLElement {
  const close = {
    class: "button close",
    href: route(tab),
    "aria-label": `Close, back to all ${tab === "reconfigure" ? "servers" : tab}`,
  };
  return h(
    "article",
    { class: "browse-page", "aria-label": name },
    h(
      "header",
      {},
      h("h2", { class: "mono ros-name", title: name }, ...breakable(name)),
      h("a", close, "×"),
    ),
    ...children,
  );
}

/** Make a whole row of a table a target for the mouse; the keyboard has the link in it. */
export function followOnClick(row: HTMLElement, link: HTMLAnchorElement): void {
  row.addEventListener("click", ({ target }) => {
    if (target instanceof Element && target.closest("a, button") === null) link.click();
  });
}
