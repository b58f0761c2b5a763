/** The Hubs tab: the links to other hubs, and the hubs behind them. */
import "./hubs.css";

import { type Child, h, replace } from "../dom";
import { ago, bandwidth, hertz, whole } from "../format";
import type { DataSource } from "../source";
import type { MakeView, View } from "../view";
import { type HubLink, type Hubs, ratesOf } from "./links";

/** Time between two requests, in ms. */
const INTERVAL = 1000;
const HEADS = ["Link", "Address", "Since"];
const NUMBERS = ["Round trip", "Clock", "In", "Out", "Dropped", "Lost"];
const KINDS: Record<string, string> = {
  join: "joined by this hub",
  accept: "has joined this hub",
  zenoh: "zenoh",
};

export const makeView: MakeView = (hub) => new HubsView(hub);

class HubsView implements View {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #title = h("h2", {});
  readonly #links = h("tbody");
  readonly #behind = h("tbody");
  readonly #tables: HTMLElement;
  readonly #behindPanel: HTMLElement;
  readonly #empty = h(
    "p",
    { class: "empty", hidden: true },
    "This hub is joined to no other hub. To join one: ",
    h("code", {}, "fibws hub --join ws://OTHER:9090"),
  );
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  #before: Hubs | null = null;
  #timer: number | undefined;
  #stop: (() => void) | undefined;

  constructor(hub: DataSource) {
    this.#hub = hub;
    const head = (text: string): HTMLElement => h("th", { scope: "col" }, text);
    const number = (text: string): HTMLElement => h("th", { scope: "col", class: "number" }, text);
    const heads = [head("Hub"), ...HEADS.map(head), ...NUMBERS.map(number)];
    this.#tables = h(
      "div",
      { class: "panel", tabindex: 0, role: "region", "aria-label": "Links" },
      h("table", {}, h("thead", {}, h("tr", {}, ...heads)), this.#links),
    );
    this.#behindPanel = h(
      "div",
      { class: "panel", tabindex: 0, role: "region", "aria-label": "Hubs behind them" },
      h(
        "table",
        {},
        h("caption", { class: "visually-hidden" }, "Hubs that are reached by way of others"),
        h("thead", {}, h("tr", {}, head("Hub"), head("By way of"), number("Nodes"))),
        this.#behind,
      ),
    );
    this.element = h(
      "section",
      { class: "hubs", "aria-label": "Hubs" },
      this.#title,
      this.#error,
      this.#empty,
      this.#tables,
      this.#behindPanel,
    );
  }

  show(): void {
    this.#stop ??= this.#hub.state.watch((state) => {
      this.#before = null;
      if (state === "open") void this.#refresh();
    });
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    window.clearTimeout(this.#timer);
  }

  async #refresh(): Promise<void> {
    window.clearTimeout(this.#timer);
    try {
      const now = await this.#hub.call<Hubs>("/rosapi/hubs", "fibws_msgs/GetHubs");
      this.#draw(now);
      this.#before = now;
      this.#error.hidden = true;
    } catch (error) {
      replace(this.#error, (error as Error).message);
      this.#error.hidden = false;
    }
    if (this.#stop !== undefined) {
      this.#timer = window.setTimeout(() => void this.#refresh(), INTERVAL);
    }
  }

  #draw(now: Hubs): void {
    replace(this.#title, "This hub: ", now.hub.name);
    const behind = now.hubs.filter(({ distance }) => distance > 1);
    this.#empty.hidden = now.links.length > 0;
    this.#tables.hidden = now.links.length === 0;
    this.#behindPanel.hidden = behind.length === 0;
    replace(this.#links, ...now.links.map((link) => this.#row(link, now)));
    replace(
      this.#behind,
      ...behind.map(({ name, link, nodes }) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, name),
          h("td", {}, link),
          h("td", { class: "number" }, whole(nodes)),
        ),
      ),
    );
  }

  #row(link: HubLink, now: Hubs): HTMLElement {
    const kind = KINDS[link.kind] ?? link.kind;
    if (link.fault !== "") {
      const columns = HEADS.length + NUMBERS.length - 2;
      return h(
        "tr",
        {},
        h("th", { scope: "row" }, "–"),
        h("td", {}, kind),
        h("td", { class: "mono" }, link.address),
        h("td", { colspan: columns }, h("span", { class: "warning" }, `⚠ down: ${link.fault}`)),
      );
    }
    const rates = ratesOf(link, now, this.#before);
    const number = (...text: Child[]): HTMLElement => h("td", { class: "number" }, ...text);
    const flow = (messages: number | undefined, size: number | undefined): HTMLElement =>
      number(messages === undefined ? "–" : `${hertz(messages)}, ${bandwidth(size ?? 0)}`);
    return h(
      "tr",
      {},
      h("th", { scope: "row", title: `id ${link.id}, version ${link.version}` }, link.name),
      h("td", {}, kind),
      h("td", { class: "mono" }, link.address),
      h("td", {}, ago(now.stamp.secs - link.since.secs)),
      number(`${(1000 * link.round_trip).toFixed(1)} ms`),
      number(`${link.clock_offset < 0 ? "−" : "+"}${Math.abs(link.clock_offset).toFixed(3)} s`),
      flow(rates?.messagesIn, rates?.bytesIn),
      flow(rates?.messagesOut, rates?.bytesOut),
      number(whole(link.dropped)),
      number(whole(link.lost)),
    );
  }
}
