/** The plot below the list of topics, with curves of any topics. */

import { h, replace, setText } from "../dom";
import { download } from "../download";
import { least } from "../lists";
import type { Model } from "../model";
import type { DataSource } from "../source";
import { clock, spanFor } from "./axes";
import { Chart } from "./chart";
import { LegendEntry, STYLES } from "./curve_style";
import { csv, curvesFrom, curvesText, ranges, type ViewState } from "./plot_state";
import { type Curve, Sampler } from "./sampler";
import "./plot.css";

/** Minimum time between two frames, and the time after which one is drawn without samples, in ms. */
const FRAME = 50;
const IDLE = 200;
/** By how many CSS pixels the curves move between two frames, within these times. */
const STEP = 3;
/** Minimum time between two updates of the values in the legend, in ms. */
const LEGEND = 200;

interface Row {
  readonly curve: Curve;
  readonly sampler: Sampler;
  readonly entry: LegendEntry;
}

export class Plot {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #changed: () => void;
  readonly #samplers = new Map<string, Sampler>();
  readonly #rows: Row[] = [];
  readonly #chart = new Chart(() => this.#refresh());
  readonly #legend = h("ul", { class: "plot-legend", "aria-label": "Curves" });
  readonly #notes = h("p", { class: "plot-notes small soft", "aria-live": "polite" });
  readonly #fold = h(
    "button",
    { type: "button", class: "plot-fold", onclick: () => this.#toggleFold() },
    "Plot",
  );
  readonly #range: HTMLSelectElement;
  readonly #log = this.#checkbox("Logarithmic");
  readonly #separate = this.#checkbox("Own axes");
  readonly #separateLabel = h(
    "label",
    { title: "Each curve has an axis of its own" },
    this.#separate,
    "Own axes",
  );
  readonly #pause: HTMLButtonElement;
  /** The topics, and "" for the list, on whose pages the plot is open; elsewhere it is folded. */
  readonly #openOn = new Set<string>();
  #page = "";
  /** Why a topic is not plotted. */
  #hint = "";
  /** The time at which the plot was paused. */
  #pausedAt: number | undefined;
  #shown = false;
  #timer: number | undefined;
  /** When the next frame is due, and when the last ones were drawn. */
  #due = Infinity;
  #lastDraw = 0;
  #lastLegend = 0;
  #full = false;
  #stopRates: (() => void) | undefined;

  /** `changed` is called when the state changes that belongs into the URL. */
  constructor(hub: DataSource, model: Model, changed: () => void) {
    this.#hub = hub;
    this.#model = model;
    this.#changed = changed;
    this.#range = h(
      "select",
      { "aria-label": "Time range", onchange: () => this.#update() },
      ...ranges.all.map(({ seconds, label }) => h("option", { value: seconds }, label)),
    );
    this.#range.value = ranges.usual;
    this.#pause = h("button", { type: "button", onclick: () => this.#togglePause() }, "Pause");
    const clear = { title: "Discard the samples so far", onclick: () => this.#clear() };
    const save = { title: "Save the samples as a file", onclick: () => this.#save() };
    const close = {
      class: "plot-close",
      title: "Remove all curves",
      "aria-label": "Close the plot",
      onclick: () => this.close(),
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
          this.#separateLabel,
          h("label", { title: "Logarithmic axis" }, this.#log, "Log"),
          this.#range,
          this.#pause,
          h("button", { type: "button", ...clear }, "Clear"),
          h("button", { type: "button", ...save }, "CSV"),
        ),
        h("button", { type: "button", ...close }, "×"),
      ),
      this.#chart.element,
      this.#notes,
    );
    // The canvas does not follow the colour scheme by itself.
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#restyle());
  }

  /** Add a curve, or scroll to it if it exists already; the plot opens on the current page. */
  add(topic: string, path: string): void {
    this.#openOn.add(this.#page);
    this.#hint = "";
    const named = this.#samplers.get(topic)?.named(path) ?? path;
    const existing = this.#rows.find(
      ({ curve, sampler }) => sampler.topic === topic && curve.path === named,
    );
    if (existing === undefined) this.#addRow(topic, path);
    this.#update();
    existing?.entry.element.scrollIntoView({ block: "nearest" });
  }

  /** Show why a topic is not plotted. */
  showHint(why: string): void {
    this.#hint = why;
    this.#openOn.add(this.#page);
    this.#update();
  }

  /** Remove all curves, and hide the plot. */
  close(): void {
    for (const row of [...this.#rows]) this.#remove(row);
    this.#hint = "";
    this.#full = false;
    this.#openOn.clear();
    if (this.#pausedAt !== undefined) this.#togglePause();
    this.#update();
  }

  /** The plot becomes visible on the page of a topic, or beside none; with the state in the URL. */
  show(page: string, state: URLSearchParams | null): void {
    this.#page = page;
    this.#shown = true;
    if (state !== null) this.#restore(state);
    for (const sampler of this.#samplers.values()) sampler.start();
    this.#stopRates ??= this.#model.rates.watch(() => this.#refresh());
    this.#update();
  }

  hide(): void {
    this.#shown = false;
    window.clearTimeout(this.#timer);
    this.#due = Infinity;
    for (const sampler of this.#samplers.values()) sampler.stop();
    this.#stopRates?.();
    this.#stopRates = undefined;
  }

  /** The state that belongs into the URL: `?plot=/pose:position.x,/pose:position.y&range=10`. */
  get state(): ViewState {
    if (this.#rows.length === 0) return {};
    return {
      plot: curvesText(this.#rows.map(({ sampler, curve }) => [sampler.topic, curve.path])),
      range: this.#range.value === ranges.usual ? "" : this.#range.value,
      log: this.#log.checked,
      own_axes: this.#separate.checked,
      folded: this.#isFolded,
    };
  }

  #restore(state: URLSearchParams): void {
    const curves = curvesFrom(state.get("plot") ?? "");
    const wanted = new Set(curves.map((curve) => curvesText([curve])));
    for (const row of [...this.#rows]) {
      const name = curvesText([[row.sampler.topic, row.curve.path]]);
      if (!wanted.delete(name)) this.#remove(row);
    }
    for (const curve of curves) if (wanted.has(curvesText([curve]))) this.#addRow(...curve);
    this.#range.value = ranges.usual;
    if (ranges.all.some(({ seconds }) => String(seconds) === state.get("range")))
      this.#range.value = state.get("range") ?? "";
    this.#log.checked = state.has("log");
    this.#separate.checked = state.has("own_axes");
    if (state.has("folded")) this.#openOn.delete(this.#page);
    else this.#openOn.add(this.#page);
  }

  get #isFolded(): boolean {
    return !this.#openOn.has(this.#page);
  }

  #checkbox(label: string): HTMLInputElement {
    return h("input", {
      type: "checkbox",
      "aria-label": label,
      onchange: () => this.#update(),
    });
  }

  #addRow(topic: string, path: string): void {
    const style = Array.from({ length: STYLES }, (_, at) => at).find((at) =>
      this.#rows.every(({ entry }) => entry.style !== at),
    );
    this.#full = style === undefined;
    if (style === undefined) return;
    let sampler = this.#samplers.get(topic);
    if (sampler === undefined) {
      sampler = new Sampler(this.#hub, topic, () => this.#refresh());
      this.#samplers.set(topic, sampler);
      if (this.#shown) sampler.start();
    }
    const entry = new LegendEntry(topic, path, style, () => {
      this.#remove(row);
      this.#update();
    });
    const row: Row = { curve: sampler.add(path), sampler, entry };
    this.#rows.push(row);
  }

  #remove(row: Row): void {
    this.#rows.splice(this.#rows.indexOf(row), 1);
    this.#full = false;
    if (row.sampler.remove(row.curve)) this.#samplers.delete(row.sampler.topic);
  }

  #clear(): void {
    for (const { curve } of this.#rows) curve.samples.clear();
    if (this.#pausedAt !== undefined) this.#togglePause();
    this.#restyle();
  }

  #save(): void {
    const curves = this.#rows.map(({ curve, sampler }) => ({
      name: [sampler.topic, curve.path] as const,
      samples: curve.samples.all(),
    }));
    download("plot.csv", new Blob([csv(curves)], { type: "text/csv" }));
  }

  #togglePause(): void {
    this.#pausedAt = this.#pausedAt === undefined ? this.#hub.clock.now() / 1000 : undefined;
    this.#pause.classList.toggle("on", this.#pausedAt !== undefined);
    setText(this.#pause, this.#pausedAt === undefined ? "Pause" : "Resume");
    this.#refresh();
  }

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
    this.#separateLabel.hidden = this.#rows.length < 2;
    replace(this.#legend, ...this.#rows.map(({ entry }) => entry.element));
    this.#restyle();
    this.#changed();
  }

  /** Draw everything again, with the current colours. */
  #restyle(): void {
    if (!this.element.isConnected) return;
    const { color, borderTopColor } = getComputedStyle(this.#notes);
    this.#chart.set(
      this.#rows.map(({ curve: { samples }, entry: { style, colour } }) => ({
        samples,
        style,
        colour,
      })),
      {
        ink: color,
        line: borderTopColor,
        logarithmic: this.#log.checked,
        separate: this.#separate.checked && this.#rows.length > 1,
      },
    );
    this.#lastLegend = 0;
    this.#refresh(0);
  }

  /** Draw a frame some time after the last one, in ms; by default once the curves have moved. */
  #refresh(delay = this.#pauseBetweenFrames): void {
    const due = this.#lastDraw + delay;
    if (!this.#shown || this.#due <= due) return;
    this.#due = due;
    window.clearTimeout(this.#timer);
    this.#timer = window.setTimeout(
      () => requestAnimationFrame(() => this.#frame()),
      Math.max(0, due - performance.now()),
    );
  }

  get #pauseBetweenFrames(): number {
    const moving = (1000 * STEP * this.#span) / this.#chart.width;
    return Math.min(IDLE, Math.max(FRAME, moving));
  }

  #frame(): void {
    this.#due = Infinity;
    this.#lastDraw = performance.now();
    if (!this.#shown) return;
    const now = this.#pausedAt ?? this.#hub.clock.now() / 1000;
    const isPaused = this.#pausedAt !== undefined;
    if (!this.#isFolded) this.#chart.draw(now, this.#span, isPaused);
    const pointed = this.#chart.pointed;
    const isStill = isPaused || pointed !== undefined;
    if (isStill || this.#lastDraw - this.#lastLegend >= LEGEND) {
      this.#lastLegend = this.#lastDraw;
      this.#showValues(pointed ?? this.#pausedAt);
      this.#showNotes(pointed);
    }
    // The time axis moves even without new samples.
    if (this.#rows.length > 0 && !isPaused) this.#refresh(IDLE);
  }

  /** The length of the time axis in seconds: it grows with the curves up to the chosen range. */
  get #span(): number {
    const now = this.#pausedAt ?? this.#hub.clock.now() / 1000;
    const first = least(
      this.#rows.map(({ curve }) => curve.samples.first ?? now),
      now,
    );
    return spanFor(now - first, Number(this.#range.value));
  }

  #showValues(time: number | undefined): void {
    const isSeparate = this.#separate.checked && this.#rows.length > 1;
    let isRenamed = false;
    this.#rows.forEach(({ curve, entry }, at) => {
      isRenamed = entry.showPath(curve.path) || isRenamed;
      entry.showValue(time === undefined ? curve.samples.newest : curve.samples.valueAt(time));
      entry.showRange(isSeparate ? this.#chart.extents[at] : undefined);
    });
    if (isRenamed) this.#changed();
  }

  #showNotes(pointed: number | undefined): void {
    const all: string[] = [];
    if (pointed !== undefined) all.push(`At ${clock(pointed)}.`);
    if (this.#hint !== "") all.push(this.#hint);
    if (this.#full) all.push(`At most ${STYLES} curves; remove one first.`);
    if (this.#chart.isOffLogarithm)
      all.push("A logarithmic axis cannot show values of zero and below.");
    if (this.#chart.hasFlatCurve)
      all.push("A curve is flat beside a larger one: “Own axes” shows each in full height.");
    for (const { topic, error, missing } of this.#samplers.values()) {
      if (error !== "") all.push(`${topic}: ${error}`);
      if (missing !== "") all.push(`${topic} has no number at ${missing} now.`);
    }
    setText(this.#notes, all.join(" "));
  }
}
