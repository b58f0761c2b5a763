/** A plot of curves of any topics: below the list of topics, on the pages of actions, and in dashboards. */

import { h, replace, setText } from "../dom";
import { download } from "../download";
import { dropFields } from "../field_drag";
import { least } from "../lists";
import type { Model } from "../model";
import type { DataSource } from "../source";
import { clock, type Extent, extentOf, spanFor } from "./axes";
import type { Chart } from "./chart";
import { LegendEntry } from "./curve_style";
import { Expression, ExpressionError } from "./expression";
import { PlotOptions } from "./plot_options";
import {
  type CurveName,
  csv,
  curvesFrom,
  curvesText,
  elementsCsv,
  type ViewState,
} from "./plot_state";
import { Curve, type Recorder, Sampler } from "./sampler";
import { sharedCursor } from "./shared_cursor";
import "./plot.css";

/** Minimum time between two frames, and the time after which one is drawn without samples, in ms. */
const FRAME = 50;
const IDLE = 200;
/** The pause after a frame is this many times as long as drawing it took. */
const REST = 15;
/** By how many CSS pixels the curves move between two frames, within these times. */
const STEP = 4;
/** Minimum time between two updates of the values in the legend, in ms. */
const LEGEND = 200;

interface Row {
  readonly curve: Curve;
  readonly sampler: Sampler;
  readonly entry: LegendEntry;
}

export class Plot {
  readonly element: HTMLElement;
  readonly #source: DataSource;
  readonly #model: Model;
  readonly #changed: () => void;
  readonly #aborter = new AbortController();
  readonly #samplers = new Map<string, Sampler>();
  readonly #rows: Row[] = [];
  readonly #place = h("div", { class: "plot-place" });
  readonly #legend = h("ul", { class: "plot-legend", "aria-label": "Curves" });
  readonly #notes = h("p", { class: "plot-notes small soft", "aria-live": "polite" });
  readonly #fold = h(
    "button",
    { type: "button", class: "plot-fold", onclick: () => this.#toggleFold() },
    "Plot",
  );
  readonly #options = new PlotOptions(() => this.#update());
  readonly #settings: HTMLButtonElement;
  readonly #pause: HTMLButtonElement;
  readonly #reset: HTMLButtonElement;
  /** The topics, and "" for the list, on whose pages the plot is open; elsewhere it is folded. */
  readonly #openOn = new Set<string>();
  #chart: Chart | undefined;
  #isLoading = false;
  #page = "";
  /** Why a topic is not plotted. */
  #hint = "";
  /** The time at which the plot was paused. */
  #pausedAt: number | undefined;
  /** The time under the mouse, here or in another plot. */
  #pointed: number | undefined;
  /** Whether the mouse is in this plot. */
  #isPointing = false;
  #shown = false;
  #timer: number | undefined;
  /** When the next frame is due, when the last ones were drawn, and how long that took. */
  #due = Infinity;
  #lastDraw = 0;
  #lastLegend = 0;
  #cost = 0;
  #stops: (() => void)[] = [];

  /** `changed` is called when the state changes that belongs into the URL. */
  constructor(hub: DataSource, model: Model, changed: () => void) {
    this.#source = hub;
    this.#model = model;
    this.#changed = changed;
    const button = (text: string, title: string, onclick: () => void) =>
      h("button", { type: "button", title, onclick }, text);
    this.#pause = button("Pause", "", () => this.#togglePause());
    this.#settings = button("Settings", "Axes, and how samples are drawn", () => {
      this.#options.element.hidden = !this.#options.element.hidden;
      this.#settings.setAttribute("aria-expanded", String(!this.#options.element.hidden));
    });
    this.#settings.setAttribute("aria-expanded", "false");
    this.#reset = button("Show all", "End the zoom (Esc, or a double click)", () =>
      this.#chart?.reset(),
    );
    this.#reset.hidden = true;
    const close = {
      class: "plot-close",
      title: "Remove all curves",
      "aria-label": "Close the plot",
      onclick: () => this.#removeAll(),
    };
    this.element = h(
      "section",
      { class: "plot panel", "aria-label": "Plot", hidden: true },
      h(
        "div",
        { class: "toolbar" },
        h("h2", {}, this.#fold),
        this.#legend,
        h(
          "div",
          { class: "toolbar plot-tools" },
          this.#reset,
          this.#settings,
          this.#options.range,
          this.#pause,
          button("Clear", "Discard the samples so far", () => this.#clear()),
          button("CSV", "Save all samples as a file", () => this.#save(-Infinity, Infinity)),
          button("CSV of view", "Save what is seen as a file", () => this.#save(...this.#seen)),
        ),
        h("button", { type: "button", ...close }, "×"),
      ),
      this.#options.element,
      this.#place,
      this.#notes,
    );
    dropFields(this.element, (topic, path) => this.add(topic, path));
    // The canvas does not follow the colour scheme by itself.
    const restyle = (): void => this.#restyle();
    const { signal } = this.#aborter;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle, { signal });
  }

  /** Add a curve, or scroll to it if it exists already; the plot opens on the current page. */
  add(topic: string, text: string): void {
    this.#openOn.add(this.#page);
    this.#hint = "";
    const existing = this.#find(topic, text);
    if (existing === undefined) this.#addRow(topic, text);
    this.#update();
    existing?.entry.element.scrollIntoView({ block: "nearest" });
  }

  /** Show why a topic is not plotted. */
  showHint(why: string): void {
    this.#hint = why;
    this.#openOn.add(this.#page);
    this.#update();
  }

  /** Free what it has: it is not shown again. */
  close(): void {
    this.hide();
    this.#aborter.abort();
    this.#chart?.close();
    this.#chart = undefined;
    this.#samplers.clear();
    this.#rows.length = 0;
  }

  /** The plot becomes visible on the page of a topic, or beside none; with the state in the URL. */
  show(page: string, state: URLSearchParams | null): void {
    this.#page = page;
    this.#shown = true;
    if (state !== null) this.#restore(state);
    for (const sampler of this.#samplers.values()) sampler.start();
    if (this.#stops.length === 0) {
      this.#stops = [
        this.#model.rates.watch(() => this.#refresh()),
        sharedCursor.watch((time) => {
          this.#pointed = time;
          this.#refresh();
        }),
      ];
    }
    this.#update();
  }

  hide(): void {
    this.#shown = false;
    window.clearTimeout(this.#timer);
    this.#due = Infinity;
    for (const sampler of this.#samplers.values()) sampler.stop();
    for (const stop of this.#stops) stop();
    this.#stops = [];
  }

  /** The state that belongs into the URL: `?plot=/pose:position.x,/pose:position.y&range=10`. */
  get state(): ViewState {
    if (this.#rows.length === 0) return {};
    return {
      plot: curvesText(this.#rows.map(nameOf)),
      ...this.#options.state,
      folded: this.#isFolded,
    };
  }

  #restore(state: URLSearchParams): void {
    // Before the curves: a first one that is an array is over its index.
    this.#options.restore(state);
    const curves = curvesFrom(state.get("plot") ?? "");
    const wanted = new Set(curves.map((curve) => curvesText([curve])));
    for (const row of [...this.#rows]) {
      if (!wanted.delete(curvesText([nameOf(row)]))) this.#remove(row);
    }
    for (const curve of curves) if (wanted.has(curvesText([curve]))) this.#addRow(...curve);
    if (state.has("folded")) this.#openOn.delete(this.#page);
    else this.#openOn.add(this.#page);
  }

  get #isFolded(): boolean {
    return !this.#openOn.has(this.#page);
  }

  // Curves.

  #find(topic: string, text: string): Row | undefined {
    try {
      const expression = new Expression(text);
      const sampler = this.#samplers.get(expression.topic ?? topic);
      const { text: wanted } = expression;
      return this.#rows.find((row) => row.sampler === sampler && row.curve.isOf(wanted));
    } catch {
      // `#addRow` says why.
      return undefined;
    }
  }

  #addRow(topic: string, text: string): void {
    let expression: Expression;
    let curve: Curve;
    try {
      expression = new Expression(text);
      curve = new Curve(expression.text);
    } catch (error) {
      if (!(error instanceof ExpressionError)) throw error;
      this.#hint = error.message;
      return;
    }
    const style = this.#freeStyle();
    if (curve.isArray && this.#rows.length === 0) this.#options.across = "index";
    const sampler = this.#samplerOf(expression.topic ?? topic);
    sampler.add(curve);
    const entry = new LegendEntry(sampler.topic, curve.path, style, () => {
      this.#remove(row);
      this.#update();
    });
    const row: Row = { curve, sampler, entry };
    this.#rows.push(row);
  }

  /** The first style that no curve has. */
  #freeStyle(): number {
    const used = new Set(this.#rows.map(({ entry }) => entry.style));
    let style = 0;
    while (used.has(style)) style += 1;
    return style;
  }

  #samplerOf(topic: string): Sampler {
    let sampler = this.#samplers.get(topic);
    if (sampler === undefined) {
      const remove = (twin: Recorder): void => {
        const row = this.#rows.find(({ curve }) => curve === twin);
        if (row === undefined) return;
        this.#remove(row);
        this.#update();
      };
      sampler = new Sampler(this.#source, topic, () => this.#refresh(), remove);
      this.#samplers.set(topic, sampler);
      sampler.reach(this.#options.seconds);
      if (this.#shown) sampler.start();
    }
    return sampler;
  }

  #remove(row: Row): void {
    this.#rows.splice(this.#rows.indexOf(row), 1);
    if (row.sampler.remove(row.curve)) this.#samplers.delete(row.sampler.topic);
  }

  /** Remove all curves, and hide the plot. */
  #removeAll(): void {
    for (const row of [...this.#rows]) this.#remove(row);
    this.#hint = "";
    this.#openOn.clear();
    this.#chart?.reset();
    if (this.#pausedAt !== undefined) this.#togglePause();
    this.#update();
  }

  #clear(): void {
    for (const { curve } of this.#rows) curve.clear();
    this.#chart?.reset();
    if (this.#pausedAt !== undefined) this.#togglePause();
    this.#restyle();
  }

  /** Save what is between two values of the horizontal axis; of an X-Y plot, between two times. */
  #save(from: number, to: number): void {
    const isIndex = this.#options.across === "index";
    const text = isIndex
      ? elementsCsv(
          this.#rows.map((row) => ({ name: nameOf(row), elements: row.curve.elements ?? [] })),
          from,
          to,
        )
      : csv(
          this.#rows.map((row) => ({
            name: nameOf(row),
            samples: row.curve.samples.all(from, to),
          })),
        );
    download("plot.csv", new Blob([text], { type: "text/csv" }));
  }

  // Time.

  #togglePause(): void {
    this.#pausedAt = this.#pausedAt === undefined ? this.#source.clock.now() / 1000 : undefined;
    this.#pause.classList.toggle("on", this.#pausedAt !== undefined);
    setText(this.#pause, this.#pausedAt === undefined ? "Pause" : "Resume");
    this.#refresh();
  }

  get #now(): number {
    return this.#pausedAt ?? this.#source.clock.now() / 1000;
  }

  /** The length of the time axis in seconds: it grows with the curves up to the chosen range. */
  get #span(): number {
    const now = this.#now;
    const first = least(
      this.#rows.map(({ curve }) => curve.samples.first ?? now),
      now,
    );
    return spanFor(now - first, this.#options.seconds);
  }

  /** What is seen of the horizontal axis; of an X-Y plot, of the time. */
  get #seen(): Extent {
    const now = this.#now;
    const { across } = this.#options;
    const view = across === "xy" ? undefined : this.#chart?.view;
    if (across === "index") return view ?? [0, Infinity];
    const [from, to] = view ?? [now - this.#span, now];
    return [from, Math.min(to, now)];
  }

  // What is on the screen.

  /** Show only a line of the plot, or all of it. */
  #toggleFold(): void {
    if (!this.#openOn.delete(this.#page)) this.#openOn.add(this.#page);
    this.#update();
  }

  /** Update the panel, for other curves or settings. */
  #update(): void {
    const hasCurves = this.#rows.length > 0;
    this.element.hidden = !hasCurves && this.#hint === "";
    this.element.classList.toggle("plot-empty", !hasCurves);
    this.element.classList.toggle("plot-folded", this.#isFolded);
    this.#fold.setAttribute("aria-expanded", String(!this.#isFolded));
    this.#options.update(this.#rows.length);
    for (const sampler of this.#samplers.values()) sampler.reach(this.#options.seconds);
    replace(this.#legend, ...this.#rows.map(({ entry }) => entry.element));
    if (hasCurves && this.#chart === undefined) void this.#load();
    this.#restyle();
    this.#changed();
  }

  /** Load the code that draws. */
  async #load(): Promise<void> {
    if (this.#isLoading) return;
    this.#isLoading = true;
    try {
      const { Chart } = await import("./chart");
      if (this.#aborter.signal.aborted) return;
      this.#chart = new Chart(() => {
        this.#point();
        this.#refresh();
      });
      replace(this.#place, this.#chart.element);
    } catch (error) {
      this.#hint = `The plot could not be loaded: ${(error as Error).message}`;
    } finally {
      this.#isLoading = false;
    }
    this.#restyle();
  }

  /** Draw everything again, with the current colours. */
  #restyle(): void {
    if (!this.element.isConnected) return;
    const { color, borderTopColor } = getComputedStyle(this.#notes);
    const options = this.#options;
    this.#chart?.set(
      this.#rows.map(({ curve, entry: { style, colour } }) => ({ curve, style, colour })),
      {
        ink: color,
        line: borderTopColor,
        logarithmic: options.logarithmic,
        logarithmicAcross: options.logarithmicAcross,
        separate: options.separate && this.#rows.length > 1,
        shape: options.shape,
        across: options.across,
      },
    );
    this.#lastLegend = 0;
    this.#refresh(0);
  }

  /** Draw a frame some time after the last one, in ms; by default once the curves have moved. */
  #refresh(delay?: number): void {
    // Each message asks for a frame: nearly always, it is due already.
    if (!this.#shown || (delay === undefined && this.#due < Infinity)) return;
    const due = this.#lastDraw + (delay ?? this.#pauseBetweenFrames);
    if (this.#due <= due) return;
    this.#due = due;
    window.clearTimeout(this.#timer);
    this.#timer = window.setTimeout(
      () => requestAnimationFrame(() => this.#frame()),
      Math.max(0, due - performance.now()),
    );
  }

  get #pauseBetweenFrames(): number {
    const moving = (1000 * STEP * this.#span) / (this.#chart?.width ?? 1);
    return Math.max(REST * this.#cost, Math.min(IDLE, Math.max(FRAME, moving)));
  }

  #frame(): void {
    this.#due = Infinity;
    this.#lastDraw = performance.now();
    if (!this.#shown) return;
    const isPaused = this.#pausedAt !== undefined;
    if (!this.#isFolded) {
      this.#chart?.draw(this.#now, this.#span, isPaused);
      // While the curves move, the mouse points to another time.
      this.#point();
      this.#chart?.mark(this.#chart.pointed === undefined ? this.#pointed : undefined);
    }
    const isStill = isPaused || this.#pointed !== undefined;
    if (isStill || this.#lastDraw - this.#lastLegend >= LEGEND) {
      this.#lastLegend = this.#lastDraw;
      this.#showValues();
      this.#showNotes();
    }
    this.#reset.hidden = this.#chart?.isZoomed !== true;
    this.#cost = performance.now() - this.#lastDraw;
    // The time axis moves even without new samples.
    if (this.#rows.length > 0 && !isPaused) this.#refresh(Math.max(IDLE, REST * this.#cost));
  }

  /** Tell all plots the time under the mouse, if it is in this one. */
  #point(): void {
    if (this.#options.across !== "time") return;
    const time = this.#chart?.pointed;
    if (time !== undefined) this.#isPointing = true;
    else if (!this.#isPointing) return;
    else this.#isPointing = false;
    sharedCursor.set(time);
  }

  #showValues(): void {
    const { across } = this.#options;
    const [from, to] = this.#seen;
    const time = this.#pointed ?? this.#pausedAt;
    let isRenamed = false;
    for (const { curve, entry } of this.#rows) {
      isRenamed = entry.showPath(curve.path) || isRenamed;
      if (across === "index") {
        const { elements = new Float64Array() } = curve;
        entry.showValue(elements[Math.round(this.#chart?.pointed ?? -1)]);
        entry.showExtent(extentOf(elements.subarray(Math.max(0, Math.ceil(from)), to + 1)));
      } else {
        const { samples } = curve;
        entry.showValue(time === undefined ? samples.newest : samples.valueAt(time));
        entry.showExtent(samples.extent(from, to));
      }
    }
    if (isRenamed) this.#changed();
  }

  #showNotes(): void {
    const all: string[] = [];
    const { across } = this.#options;
    if (this.#pointed !== undefined) all.push(`At ${clock(this.#pointed)}.`);
    if (this.#hint !== "") all.push(this.#hint);
    if (this.#chart?.isOffLogarithm)
      all.push("A logarithmic axis cannot show values of zero and below.");
    if (this.#chart?.hasFlatCurve)
      all.push("A curve is flat beside a larger one: “Own axes” shows each in full height.");
    const odd = this.#rows.filter(({ curve }) => curve.isArray !== (across === "index"));
    if (odd.length > 0) {
      const names = odd.map(({ curve }) => curve.path).join(", ");
      all.push(
        across === "index"
          ? `Not an array: ${names}; arrays are as in ranges[:].`
          : `Arrays are shown over their index (Settings, “Across”): ${names}.`,
      );
    }
    if (across === "xy" && this.#rows.length < 2) all.push("An X-Y plot needs two curves.");
    for (const { topic, error, missing } of this.#samplers.values()) {
      if (error !== "") all.push(`${topic}: ${error}`);
      if (missing !== "") all.push(`${topic} has no number at ${missing} now.`);
    }
    setText(this.#notes, all.join(" "));
  }
}

function nameOf({ sampler, curve }: Row): CurveName {
  return [sampler.topic, curve.path];
}
