/** The Services tab: lists services and actions, and has a form to call a service. */
import { followOnClick } from "../browse";
import { breakable, h, replace, setText } from "../dom";
import { FilterInput, fieldsOf } from "../filter";
import { plural } from "../format";
import { isHidden } from "../hidden_names";
import type { Hub } from "../hub";
import type { ActionInfo, Graph, Model } from "../model";
import { type MakeView, route, saveState } from "../view";
import { ServicePage } from "./service_page";
import "./services.css";

export const makeView: MakeView = (hub, model) => new ServicesView(hub, model);

interface Row {
  readonly name: string;
  readonly type: string;
  readonly node: string;
}

class ServicesView {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #model: Model;
  readonly #filter = new FilterInput("Filter services", () => this.#changed());
  readonly #debug: HTMLInputElement;
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #services = h("tbody");
  readonly #actions = h("tbody");
  readonly #empty = h("p", { class: "empty" });
  readonly #actionTable: HTMLElement;
  readonly #place = h("div", { class: "browse-place scroll" });
  #page: ServicePage | undefined;
  #name = "";
  #stop: (() => void) | undefined;

  constructor(hub: Hub, model: Model) {
    this.#hub = hub;
    this.#model = model;
    this.#debug = h("input", { type: "checkbox", onchange: () => this.#changed() });
    this.#actionTable = h(
      "div",
      {},
      h("h3", { class: "service-heading" }, "Actions"),
      table("Action", this.#actions),
    );
    const list = h(
      "section",
      { class: "browse-list", "aria-label": "Services" },
      h(
        "div",
        { class: "toolbar" },
        this.#filter.element,
        h("label", {}, this.#debug, "Debug"),
        this.#count,
      ),
      h(
        "div",
        { class: "scroll" },
        table("Service", this.#services),
        this.#empty,
        this.#actionTable,
      ),
    );
    this.element = h("div", { class: "browse services" }, list, this.#place);
  }

  show([name = ""]: string[], state: URLSearchParams | null): void {
    this.#name = name;
    if (state !== null) {
      this.#filter.text = state.get("filter") ?? "";
      this.#debug.checked = state.has("debug");
    }
    this.#save();
    this.element.classList.toggle("has-page", name !== "");
    this.#place.hidden = name === "";
    this.#stop ??= this.#model.graph.watch(() => this.#update());
    this.#update();
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
  }

  #changed(): void {
    this.#save();
    this.#update();
  }

  /** `?filter=robot&debug=1` */
  #save(): void {
    saveState({ filter: this.#filter.filter.text, debug: this.#debug.checked });
  }

  #update(): void {
    const graph = this.#model.graph.value;
    const filtered = (rows: readonly Row[]): Row[] =>
      rows
        .filter(
          (row) =>
            (this.#debug.checked || !isHidden(row.name)) &&
            this.#filter.filter.shows(fieldsOf(row)),
        )
        .sort((one, other) => (one.name < other.name ? -1 : 1));
    const services = filtered(graph?.services ?? []);
    const actions = filtered((graph?.actions ?? []).map(actionRow));
    fill(this.#services, services, "services", this.#name);
    fill(this.#actions, actions, "", "");
    this.#actionTable.hidden = actions.length === 0;
    this.#empty.hidden = services.length > 0;
    setText(this.#count, plural(services.length, "service"));
    setText(
      this.#empty,
      graph === null
        ? "Waiting for the hub …"
        : this.#filter.filter.isEmpty
          ? "No services besides the hub's own (see “Debug”). Try: python -m fibws.examples.add_two_ints_server"
          : "No services match the filter.",
    );
    this.#open(graph);
  }

  /** Show the page of the chosen service; an open page keeps its form. */
  #open(graph: Graph | null): void {
    if (this.#name === "") {
      this.#page = undefined;
      replace(this.#place);
      return;
    }
    const service = graph?.services.find(({ name }) => name === this.#name);
    if (
      this.#page?.name !== this.#name ||
      (service !== undefined && this.#page.type !== service.type)
    ) {
      this.#page = new ServicePage(this.#hub, this.#model, this.#name, service?.type ?? "");
      replace(this.#place, this.#page.element);
    }
    this.#page.showNode(service?.node, graph !== null);
  }
}

/** An action may exist twice, over topics and over operations, so the row says which. */
function actionRow({ name, type, node, over_topics }: ActionInfo): Row {
  const transport = `over ${over_topics ? "topics" : "operations"}`;
  return { name, type: type === "" ? transport : `${type} ${transport}`, node };
}

function table(label: string, body: HTMLElement): HTMLTableElement {
  const head = (text: string, column: string): HTMLElement =>
    h("th", { scope: "col", class: `col-${column}` }, text);
  return h(
    "table",
    {},
    h("thead", {}, h("tr", {}, head(label, "name"), head("Type", "type"), head("Node", "node"))),
    body,
  );
}

function fill(body: HTMLElement, rows: readonly Row[], tab: string, selected: string): void {
  const text = JSON.stringify([rows, selected]);
  if (body.dataset.rows === text) return;
  body.dataset.rows = text;
  const focused = body.contains(document.activeElement)
    ? document.activeElement?.textContent
    : undefined;
  replace(
    body,
    ...rows.map(({ name, type, node }) => {
      const below = h("span", { class: "type-below ros-name", title: type }, ...breakable(type));
      const title =
        tab === ""
          ? h("span", { class: "mono ros-name", title: name }, ...breakable(name))
          : h(
              "a",
              {
                href: route(tab, name),
                class: "ros-name",
                title: name,
                "aria-current": name === selected ? "true" : null,
              },
              ...breakable(name),
            );
      const row = h(
        "tr",
        {},
        h("th", { scope: "row", class: "col-name" }, title, below),
        h("td", { class: "col-type ros-name", title: type }, ...breakable(type)),
        h(
          "td",
          { class: "col-node" },
          h(
            "a",
            { class: "mono ros-name", title: node, href: route("graph", "node", node) },
            ...breakable(node),
          ),
        ),
      );
      if (title instanceof HTMLAnchorElement) {
        followOnClick(row, title);
        if (name === focused) queueMicrotask(() => title.focus({ preventScroll: true }));
      }
      return row;
    }),
  );
}
