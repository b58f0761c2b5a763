/** A table of named parts of the graph, each with its type and its node. */
import { followOnClick } from "./browse";
import { breakable, h, replace } from "./dom";
import { route } from "./view";

export interface Row {
  readonly name: string;
  readonly type: string;
  readonly node: string;
  /** The URL fragment of its page. */
  readonly link: string;
}

export class NameTable {
  readonly element: HTMLTableElement;
  readonly #body = h("tbody");
  #shown = "";

  /** `label` is the heading of the names. */
  constructor(label: string) {
    const head = (text: string, column: string): HTMLElement =>
      h("th", { scope: "col", class: `col-${column}` }, text);
    const heads = [head(label, "name"), head("Type", "type"), head("Node", "node")];
    this.element = h("table", {}, h("thead", {}, h("tr", {}, ...heads)), this.#body);
  }

  /** Show rows sorted by name; `selected` is the link of the chosen one. */
  show(rows: readonly Row[], selected: string): void {
    const sorted = [...rows].sort((one, other) => (one.link < other.link ? -1 : 1));
    const text = JSON.stringify([sorted, selected]);
    if (this.#shown === text) return;
    this.#shown = text;
    const { activeElement } = document;
    const focused = this.#body.contains(activeElement) && activeElement?.getAttribute("href");
    replace(this.#body, ...sorted.map((row) => tableRow(row, selected)));
    for (const link of focused ? this.#body.querySelectorAll("a") : []) {
      if (link.getAttribute("href") === focused) link.focus({ preventScroll: true });
    }
  }
}

function tableRow({ name, type, node, link }: Row, selected: string): HTMLElement {
  const title = h(
    "a",
    {
      href: link,
      class: "ros-name",
      title: name,
      "aria-current": link === selected ? "true" : null,
    },
    ...breakable(name),
  );
  const below = h("span", { class: "type-below ros-name", title: type }, ...breakable(type));
  const provider = h(
    "a",
    { class: "mono ros-name", title: node, href: route("graph", "node", node) },
    ...breakable(node),
  );
  const row = h(
    "tr",
    {},
    h("th", { scope: "row", class: "col-name" }, title, below),
    h("td", { class: "col-type ros-name", title: type }, ...breakable(type)),
    h("td", { class: "col-node" }, node !== "" && provider),
  );
  followOnClick(row, title);
  return row;
}
