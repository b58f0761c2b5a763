/** A table of named parts of the graph, each with its type and its node. */
import { followOnClick } from "./browse";
import { breakable, h, setAttribute, setName } from "./dom";
import { KeyedRows } from "./keyed_rows";
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
  readonly #rows = new KeyedRows<Row, RowElement, string>(this.#body, tableRow, ({ link }) => link);

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
    this.#rows.show(sorted);
    for (const row of sorted) this.#rows.get(row.link)?.show(row, selected);
  }
}

/** A row of the table on the page. */
interface RowElement {
  readonly element: HTMLElement;
  show(row: Row, selected: string): void;
}

function tableRow({ name, link }: Row): RowElement {
  const title = h("a", { href: link, class: "ros-name", title: name }, ...breakable(name));
  const below = h("span", { class: "type-below ros-name" });
  const typeCell = h("td", { class: "col-type ros-name" });
  const provider = h("a", { class: "mono ros-name" });
  const element = h(
    "tr",
    {},
    h("th", { scope: "row", class: "col-name" }, title, below),
    typeCell,
    h("td", { class: "col-node" }, provider),
  );
  followOnClick(element, title);
  return {
    element,
    show: ({ type, node }, selected) => {
      if (link === selected) title.setAttribute("aria-current", "true");
      else title.removeAttribute("aria-current");
      setName(below, type);
      setName(typeCell, type);
      setName(provider, node);
      provider.hidden = node === "";
      setAttribute(provider, "href", route("graph", "node", node));
    },
  };
}
