/** The Dashboard tab: panels side by side, whose layout is kept in this browser or shared by the hub. */
import "./dashboard.css";

import { copyable } from "../copy_button";
import { h, reorder, replace, setText } from "../dom";
import type { Graph, Model } from "../model";
import type { DataSource } from "../source";
import { curvesText } from "../topics/plot_state";
import type { MakeView, View } from "../view";
import { autoLayout } from "./auto";
import type { Context } from "./context";
import {
  add,
  type Bar,
  type Direction,
  insert,
  isSame,
  type Layout,
  MAX_PANES,
  mapPanes,
  move,
  newPane,
  panesOf,
  placesOf,
  remove,
  resize,
  type Side,
} from "./layout";
import { type Changes, PaneView } from "./pane";
import type { PlotPanel } from "./pieces";
import { LayoutStore } from "./store";
import { Tools } from "./tools";

export const makeView: MakeView = (hub, model) => new DashboardView(hub, model);

/** Phones have panes below one another. */
const PHONE = "(width < 44rem), (height < 30rem) and (pointer: coarse)";
/** Phones that are held in both hands: a stick is at each thumb. */
const WIDE_PHONE = "(height < 30rem) and (pointer: coarse) and (orientation: landscape)";
/** Views that one drives by, the best first. */
const VISTAS = ["image", "3d", "map"];
/** How many changes can be undone. */
const MAX_UNDO = 20;
/** Time from the last action of the user to the look at the settings of panels, in ms. */
const SETTLE = 400;
/** Time after which the panels of a hidden page end their subscriptions, in ms. */
const HIDDEN = 10_000;
/** Parts of the room beside a bar by which keys move it. */
const STEP = 0.02;
const LARGE_STEP = 0.1;

/** The pane that fills the dashboard, or the picture with the sticks on it. */
type Large = number | "sticks" | undefined;

class DashboardView implements View {
  readonly element: HTMLElement;
  readonly #model: Model;
  readonly #store: LayoutStore;
  readonly #tools: Tools;
  readonly #context: Context;
  readonly #panes = new Map<number, PaneView>();
  readonly #stage = h("div", {
    class: "panes",
    onclick: () => this.#settle(),
    onchange: () => this.#settle(),
    onkeyup: () => this.#settle(),
  });
  readonly #bars = h("div", { class: "pane-bars" });
  readonly #dots = h("nav", { class: "pane-dots", "aria-label": "Panels" });
  readonly #empty = h("div", { class: "empty" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #changes: Changes = {
    choose: (id, view, name) => {
      const pane = newPane(view, name);
      this.#change(mapPanes(this.#layout, (each) => (each.id === id ? pane : each)));
      this.#panes.get(pane.id)?.element.focus();
    },
    split: (id, side) => this.#insert(id, side),
    move: (id, at, side) => this.#change(move(this.#layout, id, at, side)),
    maximize: (id) => this.#enlarge(this.#large === id ? undefined : id),
    close: (id) => this.#close(id),
    others: (id) => [...this.#panes.values()].filter((each) => each.id !== id),
  };
  /** Panes that are scrolled away, or behind a large one, are not visible. */
  readonly #observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      target.toggleAttribute("data-seen", isIntersecting);
    }
    this.#showPanes();
  });
  readonly #phone = matchMedia(PHONE);
  readonly #widePhone = matchMedia(WIDE_PHONE);
  #isOpen = false;
  #layout: Layout | null = null;
  #undone: (Layout | null)[] = [];
  #large: Large;
  /** Whether a phone was turned on its side, and nobody has chosen a panel since. */
  #isHandheld = false;
  /** Whether the page is visible, or was a moment ago. */
  #isWatched = true;
  #stops: (() => void)[] = [];
  #timer: number | undefined;
  #hiddenTimer: number | undefined;

  constructor(hub: DataSource, model: Model) {
    this.#model = model;
    this.#store = new LayoutStore(hub);
    this.#context = { hub, model, plot: (topic, path) => this.#plot(topic, path) };
    const dashboard = this;
    this.#tools = new Tools(this.#store, {
      get layout() {
        return dashboard.#withSettings();
      },
      get canUndo() {
        return dashboard.#undone.length > 0;
      },
      addPanel: () => this.#insert(),
      makeAuto: () => this.#makeAuto(),
      undo: () => this.#undoLast(),
      change: (layout) => this.#change(layout),
      revert: () => this.#showShared(),
      showError: (why) => this.#showError(why),
    });
    this.element = h(
      "section",
      {
        class: "dashboard",
        "aria-label": "Dashboard",
        onkeydown: (event: KeyboardEvent) => this.#press(event),
      },
      this.#tools.element,
      this.#error,
      this.#stage,
      this.#dots,
    );
    for (const query of [this.#phone, this.#widePhone]) {
      query.addEventListener("change", () => this.#turn());
    }
  }

  show([name = ""]: string[]): void {
    if (this.#stops.length === 0) {
      const onHidden = (): void => this.#watch();
      const onLeave = (): void => this.#keepSettings();
      document.addEventListener("visibilitychange", onHidden);
      window.addEventListener("pagehide", onLeave);
      this.#stops = [
        this.#model.graph.watch((graph) => this.#update(graph)),
        () => document.removeEventListener("visibilitychange", onHidden),
        () => window.removeEventListener("pagehide", onLeave),
      ];
      this.#watch();
    }
    if (!this.#isOpen || name !== this.#store.name) this.#open(name);
    this.#turn();
    void this.#loadShared();
  }

  hide(): void {
    this.#keepSettings();
    for (const stop of this.#stops) stop();
    this.#stops = [];
    this.#showPanes();
  }

  // Which layout is shown.

  #open(name: string): void {
    if (this.#isOpen) this.#keepSettings();
    this.#isOpen = true;
    this.#showError("");
    this.#undone = [];
    this.#large = undefined;
    this.#layout = this.#store.open(name);
    this.#draw();
    this.#update(this.#model.graph.value);
    this.#tools.update();
  }

  /** Get the shared layouts, and show the newest version of the one that is chosen. */
  async #loadShared(): Promise<void> {
    const store = this.#store;
    const { name } = store;
    try {
      await store.loadShared();
    } catch {
      // Nobody may read parameters here, or the connection is lost: those of the browser are left.
      return;
    }
    if (name !== store.name) return;
    if (store.isOutdated && !store.isChanged(this.#layout)) this.#showShared();
    if (name !== "" && !store.has(name)) {
      this.#showError(`There is no layout “${name}” in this browser or on the hub.`);
    }
    this.#tools.update();
  }

  #showShared(): void {
    try {
      this.#layout = this.#store.takeShared();
    } catch (error) {
      this.#showError(`The layout “${this.#store.name}” of the hub: ${(error as Error).message}`);
      return;
    }
    this.#showError("");
    this.#draw();
    this.#tools.update();
  }

  // Changes of the layout.

  /** Show and keep another layout, and remember this one. */
  #change(layout: Layout | null, isAuto = false): void {
    if (panesOf(layout).length > MAX_PANES) {
      this.#showError(`At most ${MAX_PANES} panels; close one first.`);
      return;
    }
    this.#showError("");
    this.#remember(this.#withSettings());
    this.#set(layout, isAuto);
  }

  /** Let a layout be brought back by "Undo". */
  #remember(layout: Layout | null): void {
    this.#undone = [...this.#undone.slice(1 - MAX_UNDO), layout];
  }

  #undoLast(): void {
    const [last] = this.#undone.splice(-1);
    if (last !== undefined) this.#set(last, false);
  }

  #set(layout: Layout | null, isAuto: boolean): void {
    this.#layout = layout;
    this.#store.isAuto = isAuto;
    this.#draw();
    this.#layout = this.#withSettings();
    this.#store.keep(this.#layout);
    this.#tools.update();
  }

  #insert(at?: number, side: Side = "right"): void {
    const pane = newPane();
    const layout = this.#withSettings();
    this.#large = undefined;
    this.#change(at === undefined ? add(layout, pane) : insert(layout, at, side, pane));
    const { element } = this.#panes.get(pane.id) ?? {};
    element?.scrollIntoView({ block: "nearest" });
    element?.focus({ preventScroll: true });
  }

  /** Close a pane; the focus goes to the next one. */
  #close(id: number): void {
    const order = panesOf(this.#layout);
    const at = order.findIndex((pane) => pane.id === id);
    const next = order[at + 1] ?? order[at - 1];
    this.#change(remove(this.#layout, id));
    if (next === undefined) this.#tools.focus();
    else this.#panes.get(next.id)?.element.focus({ preventScroll: true });
  }

  #makeAuto(): void {
    const graph = this.#model.graph.value;
    const layout = graph && autoLayout(graph, this.#context.hub.canPublish);
    if (layout === null) this.#showError("There is nothing to show in the graph so far.");
    else this.#change(this.#reused(layout), this.#store.name === "");
  }

  /** A layout with the panes that there are already, where they show the same. */
  #reused(layout: Layout): Layout | null {
    const old = panesOf(this.#withSettings());
    return mapPanes(layout, (pane) => {
      const same = old.findIndex(({ view, name }) => view === pane.view && name === pane.name);
      return old.splice(same, same === -1 ? 0 : 1)[0] ?? pane;
    });
  }

  #plot(topic: string, path: string): void {
    const plots = [...this.#panes.values()].filter(({ view }) => view === "plot");
    const panel = plots.find((each) => each.panel !== undefined)?.panel as PlotPanel | undefined;
    if (panel !== undefined) panel.add(topic, path);
    else {
      const pane = newPane("plot", "", { plot: curvesText([[topic, path]]) });
      this.#change(add(this.#withSettings(), pane));
    }
  }

  /** The layout with the current settings of its panels. */
  #withSettings(): Layout | null {
    return mapPanes(this.#layout, (pane) => ({
      ...pane,
      config: this.#panes.get(pane.id)?.config ?? pane.config,
    }));
  }

  /** Keep the settings of panels a moment after the user has done something. */
  #settle(): void {
    window.clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#keepSettings(), SETTLE);
  }

  #keepSettings(): void {
    window.clearTimeout(this.#timer);
    const layout = this.#withSettings();
    if (isSame(layout, this.#layout)) return;
    this.#layout = layout;
    this.#store.keep(this.#layout);
    this.#tools.update();
  }

  // What is on the screen.

  #update(graph: Graph | null): void {
    if (graph !== null && this.#store.isAuto) this.#extend(graph);
    for (const pane of this.#panes.values()) pane.update(graph);
    if (this.#layout === null) this.#drawEmpty();
  }

  /** Add what has come into the graph, until the user has changed something. */
  #extend(graph: Graph): void {
    const layout = autoLayout(graph, this.#context.hub.canPublish);
    const key = ({ view, name }: { view: string; name: string }) => `${view} ${name}`;
    const present = new Set(panesOf(this.#layout).map(key));
    if (layout === null || panesOf(layout).every((pane) => present.has(key(pane)))) return;
    this.#layout = this.#reused(layout);
    this.#draw();
  }

  #draw(): void {
    const { panes, bars } = placesOf(this.#layout);
    const ids = new Set(panes.map(({ pane }) => pane.id));
    for (const [id, view] of this.#panes) {
      if (ids.has(id)) continue;
      view.close();
      this.#observer.unobserve(view.element);
      view.element.remove();
      this.#panes.delete(id);
    }
    const graph = this.#model.graph.value;
    for (const { pane } of panes) {
      if (this.#panes.has(pane.id)) continue;
      const view = new PaneView(pane, this.#context, this.#changes);
      this.#panes.set(pane.id, view);
      this.#stage.append(view.element);
      this.#observer.observe(view.element);
    }
    const elements = panes.flatMap(({ pane }) => this.#panes.get(pane.id)?.element ?? []);
    this.#stage.append(this.#bars, this.#empty);
    reorder(this.#stage, [...elements, this.#bars, this.#empty]);
    replace(this.#bars, ...bars.map(({ direction }, at) => this.#bar(direction, at)));
    this.#place();
    for (const { pane } of panes) this.#panes.get(pane.id)?.update(graph);
    this.#empty.hidden = panes.length > 0;
    if (panes.length === 0) this.#drawEmpty();
    if (typeof this.#large === "number" && !ids.has(this.#large)) this.#large = undefined;
    this.#drawLarge();
  }

  /** Put all panes and bars to their places. */
  #place(): void {
    const { panes, bars } = placesOf(this.#layout);
    const put = (element: HTMLElement | undefined, parts: Record<string, number>): void => {
      for (const [name, part] of Object.entries(parts)) {
        element?.style.setProperty(`--${name}`, `${100 * part}%`);
      }
    };
    for (const { pane, x, y, width: w, height: t } of panes) {
      put(this.#panes.get(pane.id)?.element, { x, y, w, t });
    }
    bars.forEach(({ direction, x, y, length, share }, at) => {
      const bar = this.#bars.children[at] as HTMLElement | undefined;
      const [w, t] = direction === "row" ? [0, length] : [length, 0];
      put(bar, { x, y, w, t });
      bar?.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    });
  }

  #drawEmpty(): void {
    const graph = this.#model.graph.value;
    const text = (...words: (string | Node)[]) => h("p", {}, ...words);
    if (graph === null) {
      replace(this.#empty, text("Waiting for the hub …"));
    } else if (autoLayout(graph, this.#context.hub.canPublish) === null) {
      replace(
        this.#empty,
        text(
          "Nothing to show yet: publish sensor_msgs/Image, nav_msgs/OccupancyGrid, /tf or others, or try",
        ),
        copyable("fibws demo robot", "the command"),
      );
    } else {
      replace(this.#empty, text("No panels: “Auto” makes some, “Add panel” adds one."));
    }
  }

  #showPanes(): void {
    const isShown = this.#stops.length > 0 && this.#isWatched;
    for (const pane of this.#panes.values()) {
      pane.setVisible(isShown && pane.element.hasAttribute("data-seen"));
    }
  }

  /** Follow whether the page is visible. */
  #watch(): void {
    window.clearTimeout(this.#hiddenTimer);
    if (!document.hidden) {
      this.#isWatched = true;
      this.#showPanes();
      return;
    }
    this.#keepSettings();
    this.#hiddenTimer = window.setTimeout(() => {
      this.#isWatched = false;
      this.#showPanes();
    }, HIDDEN);
  }

  // One pane as large as the dashboard, or the screen of a phone.

  #enlarge(large: Large): void {
    const before = this.#large;
    this.#large = large;
    this.#isHandheld = false;
    this.#drawLarge();
    const pane = this.#panes.get((large ?? before) as number)?.element;
    if (pane?.contains(document.activeElement)) return;
    pane?.scrollIntoView({ block: "nearest" });
    pane?.focus({ preventScroll: true });
  }

  /** The window is that of a phone now, or of one that was turned. */
  #turn(): void {
    this.#isHandheld = this.#widePhone.matches;
    if (!this.#isHandheld && this.#large === "sticks") this.#large = undefined;
    this.#drawLarge();
  }

  /** The picture to drive by, and the sticks. */
  get #vista(): PaneView[] | undefined {
    const all = [...this.#panes.values()];
    const find = (name: string) => all.find(({ view }) => view === name);
    const [picture] = VISTAS.flatMap((name) => find(name) ?? []);
    const drive = find("teleop");
    return picture && drive && [picture, drive];
  }

  #drawLarge(): void {
    if (this.#isHandheld && this.#vista !== undefined) this.#large ??= "sticks";
    const isSticks = this.#large === "sticks";
    const large = isSticks ? (this.#vista ?? []) : [this.#panes.get(this.#large as number)];
    for (const pane of this.#panes.values()) pane.setLarge(large.includes(pane));
    const { classList } = this.element;
    classList.toggle("stacked", this.#phone.matches);
    classList.toggle("maximized", this.#large !== undefined);
    classList.toggle("sticks", isSticks);
    const dot = (label: string, target: Large) =>
      h(
        "button",
        {
          type: "button",
          class: "quiet",
          title: label,
          "aria-label": label,
          "aria-current": target === this.#large && "true",
          onclick: () => this.#enlarge(target),
        },
        target === undefined ? "×" : "●",
      );
    replace(
      this.#dots,
      this.#vista && dot("Picture and sticks", "sticks"),
      ...panesOf(this.#layout).map(({ id }) => dot(this.#panes.get(id)?.title ?? "", id)),
      dot("All panels", undefined),
    );
  }

  // Bars between panes.

  /** The bar with a number, which can be dragged or moved by keys. */
  #bar(direction: Direction, number: number): HTMLElement {
    const isRow = direction === "row";
    const current = (): Bar | undefined => placesOf(this.#layout).bars[number];
    const to = (share: number): void => {
      const bar = current();
      if (this.#layout === null || bar === undefined) return;
      // What comes into the graph must not put another bar in the place of this one.
      this.#store.isAuto = false;
      this.#layout = resize(this.#layout, bar, share);
      this.#place();
    };
    const done = (before: Layout | null): void => {
      if (!isSame(before, this.#layout)) this.#remember(before);
      this.#store.keep(this.#layout);
      this.#tools.update();
    };
    /** The layout before keys moved the bar: they are one step until it loses the focus. */
    let keyed: Layout | null = null;
    let start: { place: number; share: number; room: number; layout: Layout | null } | undefined;
    const placeOf = ({ clientX, clientY }: PointerEvent): number => (isRow ? clientX : clientY);
    const element: HTMLElement = h("div", {
      class: `pane-bar ${direction}`,
      role: "separator",
      tabindex: 0,
      "aria-orientation": isRow ? "vertical" : "horizontal",
      "aria-label": "Size of the panels beside it; arrow keys move it",
      onpointerdown: (event: PointerEvent) => {
        const { share, room } = current() ?? { share: 0.5, room: 1 };
        const { width, height } = this.#stage.getBoundingClientRect();
        element.setPointerCapture(event.pointerId);
        start = {
          place: placeOf(event),
          share,
          room: room * (isRow ? width : height),
          layout: this.#withSettings(),
        };
      },
      onpointermove: (event: PointerEvent) => {
        if (start !== undefined) to(start.share + (placeOf(event) - start.place) / start.room);
      },
      onlostpointercapture: () => {
        if (start !== undefined) done(start.layout);
        start = undefined;
      },
      ondblclick: () => {
        const before = this.#withSettings();
        to(0.5);
        done(before);
      },
      onblur: () => {
        keyed = null;
      },
      onkeydown: (event: KeyboardEvent) => {
        const before = this.#withSettings();
        const share = current()?.share ?? 0.5;
        const step = event.shiftKey ? LARGE_STEP : STEP;
        if (event.key === (isRow ? "ArrowLeft" : "ArrowUp")) to(share - step);
        else if (event.key === (isRow ? "ArrowRight" : "ArrowDown")) to(share + step);
        else if (event.key === "Home") to(0);
        else if (event.key === "End") to(1);
        else return;
        event.preventDefault();
        if (keyed !== null && this.#undone.at(-1) === keyed) this.#undone.pop();
        else keyed = before;
        done(keyed);
      },
    });
    return element;
  }

  #press(event: KeyboardEvent): void {
    // A panel may have used it, such as to end a tool.
    if (event.key !== "Escape" || event.defaultPrevented || this.#tools.closeMenu()) return;
    if (this.#large !== undefined) this.#enlarge(undefined);
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = why === "";
  }
}
