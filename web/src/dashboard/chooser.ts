/** The choice of what a pane shows: views, each with its names, and a filter for both. */
import { h, setText } from "../dom";
import { FilterInput } from "../filter";
import { KeyedRows } from "../keyed_rows";
import type { Graph } from "../model";
import type { Side } from "./layout";
import { earlierNames } from "./view_names";
import { VIEWS, type ViewKind } from "./views";

/** From as many names on, those of a view are folded. */
const FOLDED = 9;

/** What a pane shows, or is to show. */
export interface Choice {
  readonly view: string;
  readonly name: string;
}

/** A view that has something to show, and the names that match the filter. */
interface Offer {
  readonly kind: ViewKind;
  readonly names: readonly string[];
}

interface Group {
  readonly element: HTMLDetailsElement;
  readonly summary: HTMLElement;
  readonly buttons: KeyedRows<string, { readonly element: HTMLElement }>;
  /** Whether it is open without a filter, which opens all. */
  isOpen: boolean;
}

export class Chooser {
  readonly element: HTMLElement;
  readonly #current: Choice;
  readonly #views: readonly ViewKind[];
  readonly #choose: (choice: Choice) => void;
  readonly #filter = new FilterInput("Filter views", () => this.show(this.#graph));
  readonly #offers = h("div", { class: "pane-offers" });
  readonly #nothing = h("p", { class: "soft" });
  readonly #groups: KeyedRows<Offer, Group, string>;
  #graph: Graph | null = null;

  /** `canPublish`: views that publish, call or set something are offered, too. */
  constructor(current: Choice, canPublish: boolean, choose: (choice: Choice) => void) {
    this.#current = current;
    this.#views = VIEWS.filter(({ publishes = false }) => canPublish || !publishes);
    this.#choose = choose;
    this.#groups = new KeyedRows(
      this.#offers,
      (offer) => this.#group(offer),
      ({ kind }) => kind.name,
    );
    this.element = h("div", {}, this.#filter.element, this.#offers, this.#nothing);
    this.#filter.element.classList.add("pane-filter");
  }

  /** Show what a graph has; what is open, scrolled and focused stays so. */
  show(graph: Graph | null): void {
    this.#graph = graph;
    const { filter } = this.#filter;
    const offers = this.#views.flatMap((kind): Offer[] => {
      const all = graph === null ? [] : kind.offers(graph);
      const names = all.filter((name) =>
        filter.matches(name, kind.label, ...earlierNames(kind.name)),
      );
      return names.length === 0 ? [] : [{ kind, names }];
    });
    this.#groups.show(offers);
    for (const { kind, names } of offers) {
      const group = this.#groups.get(kind.name);
      if (group === undefined) continue;
      group.element.open = group.isOpen || !filter.isEmpty;
      setText(group.summary, `${kind.label}${names.length < FOLDED ? "" : ` (${names.length})`}`);
      group.buttons.show(names);
    }
    this.#nothing.hidden = offers.length > 0;
    const why = filter.isEmpty ? "Nothing." : "No views match the filter.";
    setText(this.#nothing, graph === null ? "Waiting for the hub …" : why);
  }

  #group({ kind, names }: Offer): Group {
    const summary = h("summary", {});
    const list = h("div", {});
    const element = h("details", { open: names.length < FOLDED }, summary, list);
    const buttons = new KeyedRows(list, (name: string) => ({ element: this.#button(kind, name) }));
    const group: Group = { element, summary, buttons, isOpen: names.length < FOLDED };
    summary.addEventListener("click", () => {
      // It changes after the click.
      if (this.#filter.filter.isEmpty) group.isOpen = !element.open;
    });
    return group;
  }

  #button({ name: view, label }: ViewKind, name: string): HTMLElement {
    const isCurrent = view === this.#current.view && name === this.#current.name;
    return h(
      "button",
      {
        type: "button",
        class: name === "" ? "" : "mono",
        title: name,
        "aria-current": isCurrent && "true",
        onclick: () => this.#choose({ view, name }),
      },
      name === "" ? label : name,
    );
  }
}

const SIDES: readonly Side[] = ["left", "right", "above", "below"];

/** A form that moves a pane to a side of another one; null if there is none. */
export function moveForm(
  others: readonly { readonly id: number; readonly title: string }[],
  move: (at: number, side: Side) => void,
): HTMLElement | null {
  if (others.length === 0) return null;
  const side = h(
    "select",
    { "aria-label": "Side" },
    ...SIDES.map((each) => h("option", { value: each }, each.replace(/t$/, "t of"))),
  );
  const at = h(
    "select",
    { "aria-label": "Panel", class: "grow" },
    ...others.map(({ id, title }) => h("option", { value: id }, title)),
  );
  const onsubmit = (event: Event): void => {
    event.preventDefault();
    move(Number(at.value), side.value as Side);
  };
  return h(
    "form",
    { class: "toolbar pane-move", onsubmit },
    side,
    at,
    h("button", { type: "submit" }, "Move"),
  );
}
