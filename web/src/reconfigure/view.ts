/** The Reconfigure tab: the servers of dynamic_reconfigure, each with a form, as rqt_reconfigure. */
import "./reconfigure.css";

import { h, replace, setText } from "../dom";
import { FilterInput, fieldsOf } from "../filter";
import { plural } from "../format";
import type { Model } from "../model";
import { NameTable } from "../name_table";
import type { DataSource } from "../source";
import { type MakeView, type Place, route, type View } from "../view";
import { SERVICE, TYPE } from "./configuration";
import { ServerPage } from "./server_page";

export const makeView: MakeView = (hub, model, place) => new ReconfigureView(hub, model, place);

class ReconfigureView implements View {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #place: Place;
  readonly #filter = new FilterInput("Filter servers", () => this.#changed());
  readonly #count = h("span", { class: "soft small", role: "status" });
  readonly #table = new NameTable("Server");
  readonly #empty = h("p", { class: "empty" });
  readonly #pages = h("div", { class: "browse-place scroll" });
  #page: ServerPage | undefined;
  #name = "";
  #stop: (() => void) | undefined;

  constructor(hub: DataSource, model: Model, place: Place) {
    this.#place = place;
    this.#hub = hub;
    this.#model = model;
    const list = h(
      "section",
      { class: "browse-list", "aria-label": "Servers" },
      h("div", { class: "toolbar" }, this.#filter.element, this.#count),
      h("div", { class: "scroll" }, this.#table.element, this.#empty),
    );
    this.element = h("div", { class: "browse reconfigure" }, list, this.#pages);
  }

  show([name = ""]: string[], state: URLSearchParams | null): void {
    this.#name = name;
    if (state !== null) this.#filter.text = state.get("filter") ?? "";
    this.#save();
    this.element.classList.toggle("has-page", name !== "");
    this.#pages.hidden = name === "";
    this.#stop ??= this.#model.graph.watch(() => this.#update());
    this.#update();
    this.#page?.open();
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    this.#page?.close();
  }

  #changed(): void {
    this.#save();
    this.#update();
  }

  /** `?filter=camera` */
  #save(): void {
    this.#place.save({ filter: this.#filter.filter.text });
  }

  #update(): void {
    const graph = this.#model.graph.value;
    const all = (graph?.services ?? [])
      .filter(({ name, type }) => type === TYPE && name.endsWith(`/${SERVICE}`))
      .map((service) => ({ ...service, name: service.name.slice(0, -SERVICE.length - 1) }));
    const servers = all.filter((server) => this.#filter.filter.shows(fieldsOf(server)));
    this.#table.show(
      servers.map((server) => ({ ...server, link: route("reconfigure", server.name) })),
      route("reconfigure", this.#name),
    );
    this.#empty.hidden = servers.length > 0;
    setText(this.#count, plural(servers.length, "server"));
    setText(
      this.#empty,
      graph === null
        ? "Waiting for the hub …"
        : all.length === 0
          ? "No node lets others change its parameters by dynamic_reconfigure."
          : "No servers match the filter.",
    );
    this.#open(all.find(({ name }) => name === this.#name)?.node ?? "");
  }

  /** Show the form of the chosen server. */
  #open(node: string): void {
    if (this.#page !== undefined && this.#page.name !== this.#name) {
      this.#page.close();
      this.#page = undefined;
      replace(this.#pages);
    }
    if (this.#name === "" || this.#page !== undefined) return;
    this.#page = new ServerPage(this.#hub, this.#name, node);
    replace(this.#pages, this.#page.element);
    this.#page.open();
  }
}
