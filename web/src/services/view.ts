/** The Services tab: lists services, and has a form to call one. */
import { h, replace, setText } from "../dom";
import { FilterInput, fieldsOf } from "../filter";
import { plural } from "../format";
import { isHidden } from "../hidden_names";
import type { Graph, Model } from "../model";
import { NameTable } from "../name_table";
import type { DataSource } from "../source";
import { type MakeView, type Place, route } from "../view";
import { ServicePage } from "./service_page";
import "./services.css";

export const makeView: MakeView = (hub, model, place) => new ServicesView(hub, model, place);

class ServicesView {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #place: Place;
  readonly #filter = new FilterInput("Filter services", () => this.#changed());
  readonly #debug: HTMLInputElement;
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #table = new NameTable("Service");
  readonly #empty = h("p", { class: "empty" });
  readonly #pages = h("div", { class: "browse-place scroll" });
  #page: ServicePage | undefined;
  #name = "";
  #stop: (() => void) | undefined;

  constructor(hub: DataSource, model: Model, place: Place) {
    this.#place = place;
    this.#hub = hub;
    this.#model = model;
    this.#debug = h("input", { type: "checkbox", onchange: () => this.#changed() });
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
      h("div", { class: "scroll" }, this.#table.element, this.#empty),
    );
    this.element = h("div", { class: "browse services" }, list, this.#pages);
  }

  show([name = ""]: string[], state: URLSearchParams | null): void {
    this.#name = name;
    if (state !== null) {
      this.#filter.text = state.get("filter") ?? "";
      this.#debug.checked = state.has("debug");
    }
    this.#save();
    this.element.classList.toggle("has-page", name !== "");
    this.#pages.hidden = name === "";
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
    this.#place.save({ filter: this.#filter.filter.text, debug: this.#debug.checked });
  }

  #update(): void {
    const graph = this.#model.graph.value;
    const services = (graph?.services ?? []).filter(
      (service) =>
        (this.#debug.checked || !isHidden(service.name)) &&
        this.#filter.filter.shows(fieldsOf(service)),
    );
    this.#table.show(
      services.map((service) => ({ ...service, link: route("services", service.name) })),
      route("services", this.#name),
    );
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
      replace(this.#pages);
      return;
    }
    const service = graph?.services.find(({ name }) => name === this.#name);
    if (
      this.#page?.name !== this.#name ||
      (service !== undefined && this.#page.type !== service.type)
    ) {
      this.#page = new ServicePage(this.#hub, this.#model, this.#name, service?.type ?? "");
      replace(this.#pages, this.#page.element);
    }
    this.#page.showNode(service?.node, graph !== null);
  }
}
