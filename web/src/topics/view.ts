/** The Topics tab: a list, the page of the chosen topic, and a plot. */
import { h, replace } from "../dom";
import type { Model } from "../model";
import type { DataSource } from "../source";
import { Types } from "../types";
import { type MakeView, type Place, route } from "../view";
import { NewTopic } from "./new_topic";
import { Plot } from "./plot";
import { TopicList } from "./topic_list";
import { TopicPage } from "./topic_page";
import "./topics.css";

export const makeView: MakeView = (hub, model, place) => new TopicsView(hub, model, place);

class TopicsView {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #place: Place;
  readonly #model: Model;
  readonly #plot: Plot;
  readonly #list: TopicList;
  readonly #pages = h("div", { class: "browse-place scroll" });
  readonly #new: NewTopic;
  #shown = false;
  /** Stops waiting for the type of a topic that is to be plotted. */
  #stopWaiting: (() => void) | undefined;
  #page: { readonly name: string; readonly expected: string; readonly page: TopicPage } | undefined;

  constructor(hub: DataSource, model: Model, place: Place) {
    this.#place = place;
    this.#hub = hub;
    this.#model = model;
    this.#plot = new Plot(hub, model, () => this.#save());
    this.#new = new NewTopic(model, place);
    this.#list = new TopicList(
      model,
      (topic, type) => void this.#plotTopic(topic, type),
      () => this.#save(),
      hub.canPublish ? this.#new.button : null,
    );
    this.#list.element.children[0]?.after(this.#new.element);
    this.element = h(
      "div",
      { class: "browse topics" },
      this.#list.element,
      this.#pages,
      this.#plot.element,
    );
  }

  /** `["/chatter"]` opens that topic; `["/chatter", "plot"]` also plots it. */
  show([name = "", tool]: string[], state: URLSearchParams | null): void {
    const expected = this.#new.typeOf(name);
    if (this.#page?.name !== name || this.#page.expected !== expected) {
      this.#page?.page.close();
      const page = new TopicPage(this.#hub, this.#model, this.#plot, name, expected);
      this.#page = name === "" ? undefined : { name, expected, page };
      replace(this.#pages, this.#page?.page.element);
      this.#pages.scrollTop = 0;
    }
    this.#page?.page.show();
    this.element.classList.toggle("has-page", name !== "");
    this.#pages.hidden = name === "";
    this.#list.show(name, state);
    this.#plot.show(name, state);
    this.#shown = true;
    // The state has the curves from now on: following a link to it must not add them again.
    if (tool === "plot") history.replaceState(history.state, "", route("topics", name));
    this.#save();
    this.#stopWaiting?.();
    this.#stopWaiting = undefined;
    if (tool === "plot") this.#plotWhenKnown(name);
  }

  /** Plot a topic as soon as its type is known. */
  #plotWhenKnown(name: string): void {
    let done = false;
    const stop = this.#model.graph.watch((graph) => {
      const type = graph?.topics.find((topic) => topic.name === name)?.type;
      if (done || !type) return;
      done = true;
      this.#stopWaiting?.();
      void this.#plotTopic(name, type);
    });
    if (done) stop();
    else this.#stopWaiting = stop;
  }

  hide(): void {
    this.#shown = false;
    this.#stopWaiting?.();
    this.#list.hide();
    this.#plot.hide();
    this.#page?.page.hide();
  }

  close(): void {
    this.#page?.page.close();
    this.#plot.close();
  }

  /** Put the state of list and plot into the URL, unless that is another view's by now. */
  #save(): void {
    if (this.#shown) this.#place.save({ ...this.#list.state, ...this.#plot.state });
  }

  /** Plot all numbers of a small message, or the first of a large one. */
  async #plotTopic(topic: string, type: string): Promise<void> {
    const types = new Types(await this.#model.typedefs(type).catch(() => []));
    for (const path of types.plotPaths()) this.#plot.add(topic, path);
    if (types.plotPaths().length === 0) this.#plot.showHint(`${topic} has no numbers to plot.`);
  }
}
