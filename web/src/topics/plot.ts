/** The plot below the list of topics, with curves of any topics. */
import { h, replace, setText } from "../dom";
import { hertz } from "../format";
import type { Hub } from "../hub";
import type { Model } from "../model";
import { notPositive } from "./axes";
import { Chart } from "./chart";
import { LegendEntry, STYLES } from "./curve_style";
import { type Curve, Sampler } from "./sampler";
import "./plot.css";

/** The ranges of time to choose from. */
const WINDOWS = [
  { seconds: 10, label: "10 s" },
  { seconds: 30, label: "30 s" },
  { seconds: 120, label: "2 min" },
  { seconds: 600, label: "10 min" },
];
/** Minimum time between two messages, in ms; the buffers hold ten minutes at the longer one. */
const THROTTLE = 20;
const LONG_THROTTLE = 50;
/** Minimum time between two redraws, in ms; the longer one with more than a few curves. */
const FRAME = 50;
const LONG_FRAME = 100;
const FEW = 3;
/** How many samples a single curve is drawn with, and each of many at least. */
const MAX_SAMPLES = 2000;
const MIN_SAMPLES = 500;
/** The minimum length of the time axis, in seconds. */
const MIN_SECONDS = 2;

interface Row {
  readonly curve: Curve;
  readonly sampler: Sampler;
  readonly entry: LegendEntry;
}

export class Plot {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #model: Model;
  readonly #samplers = new Map<string, Sampler>();
  readonly #rows: Row[] = [];
  readonly #chart = new Chart((time) => this.#point(time));
  readonly #legend = h("ul", { class: "plot-legend", "aria-label": "Curves" });
  readonly #notes = h("p", { class: "plot-notes small soft", "aria-live": "polite" });
  readonly #hint = h(
    "p",
    { class: "soft small" },
    "Choose a number: “Plot” in the list, or the curve icon beside a value.",
  );
  readonly #fold = h(
    "button",
    {
      type: "button",
      class: "plot-fold",
      "aria-expanded": "true",
      onclick: () => this.#toggleFold(),
    },
    "Plot",
  );
  readonly #tools: HTMLElement;
  readonly #window: HTMLSelectElement;
  readonly #log: HTMLInputElement;
  readonly #pause: HTMLButtonElement;
  /** The time at which the plot was paused. */
  #pausedAt: number | undefined;
  #pointed: number | undefined;
  #shown = false;
  /** Whether a redraw is scheduled. */
  #scheduled = false;
  #lastDraw = 0;
  #full = false;
  #stopRates: (() => void) | undefined;

  constructor(hub: Hub, model: Model) {
    this.#hub = hub;
    this.#model = model;
    this.#window = h(
      "select",
      { "aria-label": "Time range", onchange: () => this.#changeWindow() },
      ...WINDOWS.map(({ seconds, label }) => h("option", { value: seconds }, label)),
    );
    this.#window.value = "30";
    this.#log = h("input", {
      type: "checkbox",
      "aria-label": "Logarithmic",
      onchange: () => this.#recreate(),
    });
    this.#pause = h("button", { type: "button", onclick: () => this.#toggle() }, "Pause");
    this.#tools = h(
      "div",
      { class: "toolbar end" },
      h("label", { title: "Logarithmic axis" }, this.#log, "Log"),
      this.#window,
      this.#pause,
      h(
        "button",
        { type: "button", title: "Discard the samples so far", onclick: () => this.#clear() },
        "Clear",
      ),
      h(
        "button",
        {
          type: "button",
          class: "plot-all",
          title: "Remove all curves",
          onclick: () => this.#removeAll(),
        },
        "Remove all",
      ),
    );
    this.element = h(
      "section",
      { class: "plot panel", "aria-label": "Plot" },
      h(
        "div",
        { class: "toolbar" },
        h("h2", {}, this.#fold),
        this.#hint,
        this.#legend,
        this.#tools,
      ),
      this.#chart.element,
      this.#notes,
    );
    // The canvas does not follow the colour scheme by itself.
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#recreate());
    new ResizeObserver(() => this.#refresh()).observe(this.#chart.element);
    this.#recreate();
  }

  /** Add a curve, or scroll to it if it exists already. */
  add(topic: string, path: string): void {
    const existing = this.#rows.find(
      ({ curve, sampler }) => sampler.topic === topic && curve.path === path,
    );
    if (existing !== undefined) {
      existing.entry.element.scrollIntoView({ block: "nearest" });
      return;
    }
    const style = Array.from({ length: STYLES }, (_, at) => at).find((at) =>
      this.#rows.every(({ entry }) => entry.style !== at),
    );
    this.#full = style === undefined;
    if (style === undefined) {
      this.#showNotes([]);
      return;
    }
    let sampler = this.#samplers.get(topic);
    if (sampler === undefined) {
      sampler = new Sampler(this.#hub, topic, this.#throttle, () => this.#refresh());
      this.#samplers.set(topic, sampler);
      if (this.#shown) sampler.start();
    }
    const entry = new LegendEntry(topic, path, style, () => this.#remove(row));
    const row: Row = { curve: sampler.add(path), sampler, entry };
    this.#rows.push(row);
    this.#recreate();
  }

  /** Show why something is not plotted. */
  showHint(why: string): void {
    setText(this.#hint, why);
    this.#hint.hidden = false;
  }

  show(): void {
    this.#shown = true;
    for (const sampler of this.#samplers.values()) sampler.start();
    this.#stopRates ??= this.#model.rates.watch(() => this.#refresh());
    this.#recreate();
  }

  hide(): void {
    this.#shown = false;
    for (const sampler of this.#samplers.values()) sampler.stop();
    this.#stopRates?.();
    this.#stopRates = undefined;
  }

  get #throttle(): number {
    return Number(this.#window.value) > 120 ? LONG_THROTTLE : THROTTLE;
  }

  #remove(row: Row): void {
    this.#rows.splice(this.#rows.indexOf(row), 1);
    this.#full = false;
    if (row.sampler.remove(row.curve)) this.#samplers.delete(row.sampler.topic);
    this.#recreate();
  }

  #removeAll(): void {
    for (const row of [...this.#rows]) this.#remove(row);
  }

  #clear(): void {
    for (const { curve } of this.#rows) curve.samples.clear();
    if (this.#pausedAt !== undefined) this.#toggle();
    this.#refresh();
  }

  #toggle(): void {
    this.#pausedAt = this.#pausedAt === undefined ? Date.now() / 1000 : undefined;
    this.#pause.classList.toggle("on", this.#pausedAt !== undefined);
    setText(this.#pause, this.#pausedAt === undefined ? "Pause" : "Resume");
    this.#refresh();
  }

  /** Hide or show the chart; the curves remain. */
  #toggleFold(): void {
    const folded = this.element.classList.toggle("plot-folded");
    this.#fold.setAttribute("aria-expanded", String(!folded));
    this.#refresh();
  }

  #changeWindow(): void {
    for (const sampler of this.#samplers.values()) sampler.throttle = this.#throttle;
    this.#refresh();
  }

  /** Create the chart again, for other curves, colours or scales. */
  #recreate(): void {
    const hasCurves = this.#rows.length > 0;
    this.element.classList.toggle("plot-empty", !hasCurves);
    this.#hint.hidden = hasCurves;
    this.#fold.disabled = !hasCurves;
    this.#tools.hidden = !hasCurves;
    replace(this.#legend, ...this.#rows.map(({ entry }) => entry.element));
    if (!this.element.isConnected) return;
    const { color, borderTopColor } = getComputedStyle(this.#notes);
    const looks = this.#rows.map(({ entry: { style, colour } }) => ({ style, colour }));
    this.#chart.create(looks, { ink: color, line: borderTopColor }, this.#log.checked);
    this.#refresh();
  }

  /** Schedule a redraw. */
  #refresh(): void {
    if (!this.#shown || this.#scheduled) return;
    this.#scheduled = true;
    const pause = this.#rows.length > FEW ? LONG_FRAME : FRAME;
    const draw = (now: number) => {
      this.#scheduled = false;
      this.#lastDraw = now;
      this.#draw();
      // The time axis moves even without new samples.
      if (this.#rows.length > 0 && this.#pausedAt === undefined) this.#refresh();
    };
    const rest = this.#lastDraw + pause - performance.now();
    setTimeout(() => requestAnimationFrame(draw), Math.max(0, rest));
  }

  #draw(): void {
    const now = this.#pausedAt ?? Date.now() / 1000;
    const first = Math.min(now, ...this.#rows.map(({ curve }) => curve.samples.first ?? now));
    const from = Math.max(now - Number(this.#window.value), Math.min(first, now - MIN_SECONDS));
    // Each curve gets a row for each sample of all others, so the cost is quadratic.
    const limit = Math.max(MIN_SAMPLES, MAX_SAMPLES / this.#rows.length);
    const curves = this.#rows.map(({ curve }) => curve.samples.between(from, now, limit));
    this.#chart.show(curves, from, now, this.#log.checked);
    const time = this.#pointed ?? this.#pausedAt;
    for (const { curve, entry } of this.#rows)
      entry.showValue(time === undefined ? curve.samples.newest : curve.samples.valueAt(time));
    this.#showNotes(
      this.#log.checked && notPositive(curves) > 0
        ? ["A logarithmic axis cannot show values of zero and below."]
        : [],
    );
  }

  #showNotes(notes: string[]): void {
    const all = [...notes];
    if (this.#full) all.push(`At most ${STYLES} curves; remove one first.`);
    for (const { topic, error, missing } of this.#samplers.values()) {
      if (error !== "") all.push(`${topic}: ${error}`);
      if (missing !== "") all.push(`${topic} has no number at ${missing} now.`);
      const rate = this.#model.rates.value.topics.get(topic)?.messages ?? 0;
      const most = 1000 / this.#throttle;
      if (rate > 1.1 * most) all.push(`${topic} has ${hertz(rate)}; ${hertz(most)} are plotted.`);
    }
    setText(this.#notes, all.join(" "));
  }

  #point(time: number | undefined): void {
    if (time === this.#pointed) return;
    this.#pointed = time;
    this.#refresh();
  }
}
