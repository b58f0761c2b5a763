/** The services of the graph, a form to call the chosen one, and the actions. */
import { h, replace, say } from "../dom";
import { matches } from "../filter";
import { plural } from "../format";
import { isHidden } from "../hidden";
import type { Hub } from "../hub";
import type { ActionInfo, Graph, Model } from "../model";
import "../browse.css";
import { type MakeView, route } from "../view";
import { Call } from "./call";
import "./services.css";

export const makeView: MakeView = (hub, model) => new ServicesView(hub, model);

interface Offer {
  readonly name: string;
  readonly type: string;
  readonly node: string;
}

class ServicesView {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #model: Model;
  readonly #filter: HTMLInputElement;
  readonly #debug: HTMLInputElement;
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #services = h("tbody");
  readonly #actions = h("tbody");
  readonly #empty = h("p", { class: "empty" });
  readonly #actionTable: HTMLElement;
  readonly #place = h("div", { class: "browse-place scroll" });
  #call: Call | undefined;
  #name = "";
  #stop: (() => void) | undefined;

  constructor(hub: Hub, model: Model) {
    this.#hub = hub;
    this.#model = model;
    this.#filter = h("input", {
      type: "search",
      class: "grow",
      placeholder: "Filter by name, type or node",
      "aria-label": "Filter services",
      oninput: () => this.#update(),
    });
    this.#debug = h("input", { type: "checkbox", onchange: () => this.#update() });
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
        this.#filter,
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

  show([name = ""]: string[]): void {
    this.#name = name;
    this.element.classList.toggle("has-page", name !== "");
    this.#place.hidden = name === "";
    this.#stop ??= this.#model.graph.watch(() => this.#update());
    this.#update();
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
  }

  #update(): void {
    const graph = this.#model.graph.value;
    const chosen = (offers: readonly Offer[]): Offer[] =>
      offers
        .filter(
          ({ name, type, node }) =>
            (this.#debug.checked || !isHidden(name)) &&
            matches(this.#filter.value.trim(), name, type, node),
        )
        .sort((one, other) => (one.name < other.name ? -1 : 1));
    const services = chosen(graph?.services ?? []);
    const actions = chosen((graph?.actions ?? []).map(withWay));
    fill(this.#services, services, "services", this.#name);
    fill(this.#actions, actions, "", "");
    this.#actionTable.hidden = actions.length === 0;
    this.#empty.hidden = services.length > 0;
    say(this.#count, plural(services.length, "service"));
    say(
      this.#empty,
      graph === null
        ? "Waiting for the hub …"
        : this.#filter.value === ""
          ? "No services yet but the hub's own, which “Debug” shows. Try: python -m fibws.examples.add_two_ints_server"
          : "No service matches the filter.",
    );
    this.#open(graph);
  }

  /** The form of the chosen service, which stays as it is while that is there. */
  #open(graph: Graph | null): void {
    if (this.#name === "") {
      this.#call = undefined;
      replace(this.#place);
      return;
    }
    const service = graph?.services.find(({ name }) => name === this.#name);
    if (
      this.#call?.name !== this.#name ||
      (service !== undefined && this.#call.type !== service.type)
    ) {
      this.#call = new Call(this.#hub, this.#model, this.#name, service?.type ?? "");
      replace(this.#place, this.#call.element);
    }
    this.#call.tell(service?.node, graph !== null);
  }
}

/** An action may be there twice, so it is said how goals get there. */
function withWay({ name, type, node, over_topics }: ActionInfo): Offer {
  const way = `over ${over_topics ? "topics" : "operations"}`;
  return { name, type: type === "" ? way : `${type} ${way}`, node };
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

function fill(body: HTMLElement, offers: readonly Offer[], tab: string, selected: string): void {
  const text = JSON.stringify([offers, selected]);
  if (body.dataset.offers === text) return;
  body.dataset.offers = text;
  const focused = body.contains(document.activeElement)
    ? document.activeElement?.textContent
    : undefined;
  replace(
    body,
    ...offers.map(({ name, type, node }) => {
      const below = h("span", { class: "type-below" }, type);
      const title =
        tab === ""
          ? h("span", { class: "mono" }, name)
          : h(
              "a",
              { href: route(tab, name), "aria-current": name === selected ? "true" : null },
              name,
            );
      const row = h(
        "tr",
        {},
        h("th", { scope: "row", class: "col-name" }, title, below),
        h("td", { class: "col-type" }, type),
        h(
          "td",
          { class: "col-node" },
          h("a", { class: "mono", href: route("graph", "node", node) }, node),
        ),
      );
      if (title instanceof HTMLAnchorElement) {
        row.addEventListener("click", (event) => {
          if (event.target instanceof Element && event.target.closest("a") === null) title.click();
        });
        if (name === focused) queueMicrotask(() => title.focus({ preventScroll: true }));
      }
      return row;
    }),
  );
}
