/** The Actions tab: lists actions, and has a form to send one a goal. */
import { h, replace, setText } from "../dom";
import { FilterInput, fieldsOf } from "../filter";
import { plural } from "../format";
import { isHidden } from "../hidden_names";
import type { ActionInfo, Graph, Model } from "../model";
import { NameTable } from "../name_table";
import type { DataSource } from "../source";
import { type MakeView, type Place, route } from "../view";
import { ActionPage } from "./action_page";

export const makeView: MakeView = (hub, model, place) => new ActionsView(hub, model, place);

const EXAMPLE = "python -m fibws.examples.action_server";

class ActionsView {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #place: Place;
  readonly #filter = new FilterInput("Filter actions", () => this.#changed());
  readonly #debug: HTMLInputElement;
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #table = new NameTable("Action");
  readonly #empty = h("p", { class: "empty" });
  readonly #beside = h("div", { class: "browse-place scroll" });
  /** The page that is shown, and those with goals that have not ended, by their links. */
  readonly #pages = new Map<string, ActionPage>();
  #shown: ActionPage | undefined;
  /** The name, and the transport if the URL names it: an action may exist once over each. */
  #path: string[] = [];
  #stop: (() => void) | undefined;

  constructor(hub: DataSource, model: Model, place: Place) {
    this.#place = place;
    this.#hub = hub;
    this.#model = model;
    this.#debug = h("input", { type: "checkbox", onchange: () => this.#changed() });
    const list = h(
      "section",
      { class: "browse-list", "aria-label": "Actions" },
      h(
        "div",
        { class: "toolbar" },
        this.#filter.element,
        h("label", {}, this.#debug, "Debug"),
        this.#count,
      ),
      h("div", { class: "scroll" }, this.#table.element, this.#empty),
    );
    this.element = h("div", { class: "browse actions" }, list, this.#beside);
  }

  show(path: string[], state: URLSearchParams | null): void {
    this.#path = path;
    if (state !== null) {
      this.#filter.text = state.get("filter") ?? "";
      this.#debug.checked = state.has("debug");
    }
    this.#save();
    const isOpen = path.length > 0;
    this.element.classList.toggle("has-page", isOpen);
    this.#beside.hidden = !isOpen;
    this.#stop ??= this.#model.graph.watch(() => this.#update());
    this.#update();
  }

  hide(): void {
    this.#shown?.hide();
    this.#stop?.();
    this.#stop = undefined;
  }

  #changed(): void {
    this.#save();
    this.#update();
  }

  /** `?filter=robot&debug=1` */
  #save(): void {
    this.#place.save({ filter: this.#filter.filter.text, debug: this.#debug.checked });
  }

  #update(): void {
    const graph = this.#model.graph.value;
    const chosen = this.#chosen(graph);
    const actions = (graph?.actions ?? []).filter(
      (action) =>
        (this.#debug.checked || !isHidden(action.name)) &&
        this.#filter.filter.shows(fieldsOf(action)),
    );
    this.#table.show(
      actions.map((action) => ({
        name: action.name,
        type: [action.type, `over ${transport(action)}`].join(" ").trim(),
        node: action.node,
        link: link(action),
      })),
      chosen === undefined ? "" : link(chosen),
    );
    this.#empty.hidden = actions.length > 0;
    setText(this.#count, plural(actions.length, "action"));
    setText(
      this.#empty,
      graph === null
        ? "Waiting for the hub …"
        : this.#filter.filter.isEmpty
          ? `No actions. Try: ${EXAMPLE}`
          : "No actions match the filter.",
    );
    this.#open(chosen, graph !== null);
  }

  /** The action that the URL names, as if it had no type and no node while it is unknown. */
  #chosen(graph: Graph | null): ActionInfo | undefined {
    const [name, over] = this.#path;
    if (name === undefined) return undefined;
    const found = graph?.actions.find(
      (action) => action.name === name && (over === undefined || transport(action) === over),
    );
    return found ?? { name, type: "", node: "", over_topics: over !== "operations" };
  }

  /** Show the page of the chosen action; an open page keeps its form and its goals. */
  #open(chosen: ActionInfo | undefined, known: boolean): void {
    if (chosen === undefined) {
      this.#shown?.hide();
      replace(this.#beside);
      this.#closeOthers("");
      return;
    }
    const key = link(chosen);
    let page = this.#pages.get(key);
    if (page === undefined || (chosen.type !== "" && page.type !== chosen.type)) {
      page?.close();
      page = new ActionPage(this.#hub, this.#model, chosen);
      this.#pages.set(key, page);
    }
    if (this.#beside.firstElementChild !== page.element) {
      this.#shown?.hide();
      replace(this.#beside, page.element);
    }
    this.#shown = page;
    page.show();
    page.showNode(chosen.node, known);
    this.#closeOthers(key);
  }

  close(): void {
    for (const page of this.#pages.values()) page.close();
    this.#pages.clear();
  }

  #closeOthers(shown: string): void {
    for (const [key, page] of this.#pages) {
      if (key === shown || page.isActive) continue;
      page.close();
      this.#pages.delete(key);
    }
  }
}

function transport({ over_topics }: ActionInfo): "topics" | "operations" {
  return over_topics ? "topics" : "operations";
}

function link(action: ActionInfo): string {
  return route("actions", action.name, transport(action));
}
