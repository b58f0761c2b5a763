/** The plot that stays while one picks what else is to be in it, from any topic. */
import { h, replace, say } from "../dom";
import { hertz } from "../format";
import type { Hub } from "../hub";
import type { Model } from "../model";
import { Chart } from "./chart";
import { type Curve, Feed } from "./feed";
import { LegendEntry } from "./legend";
import { notPositive } from "./scales";
import { STYLES } from "./strokes";
import "./plot.css";

/** Seconds in sight. */
const WINDOWS = [
  { seconds: 10, label: "10 s" },
  { seconds: 30, label: "30 s" },
  { seconds: 120, label: "2 min" },
  { seconds: 600, label: "10 min" },
];
/** Least time between two messages, in ms: in ten minutes, the buffers hold half as many a second. */
const THROTTLE = 20;
const LONG_THROTTLE = 50;
/** Least time between two pictures, in ms; and if they have more than a few curves. */
const FRAME = 50;
const LONG_FRAME = 100;
const FEW = 3;
/** Samples that one curve alone is drawn with, and each of many. */
const MOST = 2000;
const FEWEST = 500;
/** Seconds that an axis has at least. */
const SHORTEST = 2;

interface Row {
  readonly curve: Curve;
  readonly feed: Feed;
  readonly entry: LegendEntry;
}

export class Plot {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #model: Model;
  readonly #feeds = new Map<string, Feed>();
  readonly #rows: Row[] = [];
  readonly #chart = new Chart((time) => this.#point(time));
  readonly #legend = h("ul", { class: "plot-legend", "aria-label": "Curves" });
  readonly #notes = h("p", { class: "plot-notes small soft", "aria-live": "polite" });
  readonly #hint = h(
    "p",
    { class: "soft small" },
    "Pick a number: “Plot” in the list, or the curve beside a value.",
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
  /** The time at which the picture stands still. */
  #pausedAt: number | undefined;
  #pointed: number | undefined;
  #shown = false;
  /** Whether a picture is asked for. */
  #due = false;
  #drawn = 0;
  #full = false;
  #stopRates: (() => void) | undefined;

  constructor(hub: Hub, model: Model) {
    this.#hub = hub;
    this.#model = model;
    this.#window = h(
      "select",
      { "aria-label": "Time in sight", onchange: () => this.#rewind() },
      ...WINDOWS.map(({ seconds, label }) => h("option", { value: seconds }, label)),
    );
    this.#window.value = "30";
    this.#log = h("input", {
      type: "checkbox",
      "aria-label": "Logarithmic",
      onchange: () => this.#make(),
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
        { type: "button", title: "Forget the samples so far", onclick: () => this.#clear() },
        "Clear",
      ),
      h(
        "button",
        {
          type: "button",
          class: "plot-all",
          title: "Take all curves away",
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
    // The canvas does not follow the page's colours by itself.
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#make());
    new ResizeObserver(() => this.#refresh()).observe(this.#chart.element);
    this.#make();
  }

  /** Add a curve; one that is there already is looked at again. */
  add(topic: string, path: string): void {
    const there = this.#rows.find(({ curve, feed }) => feed.topic === topic && curve.path === path);
    if (there !== undefined) {
      there.entry.element.scrollIntoView({ block: "nearest" });
      return;
    }
    const style = Array.from({ length: STYLES }, (_, at) => at).find((at) =>
      this.#rows.every(({ entry }) => entry.style !== at),
    );
    this.#full = style === undefined;
    if (style === undefined) {
      this.#note([]);
      return;
    }
    let feed = this.#feeds.get(topic);
    if (feed === undefined) {
      feed = new Feed(this.#hub, topic, this.#throttle, () => this.#refresh());
      this.#feeds.set(topic, feed);
      if (this.#shown) feed.start();
    }
    const entry = new LegendEntry(topic, path, style, () => this.#remove(row));
    const row: Row = { curve: feed.add(path), feed, entry };
    this.#rows.push(row);
    this.#make();
  }

  /** Say why something is not plotted. */
  say(why: string): void {
    say(this.#hint, why);
    this.#hint.hidden = false;
  }

  show(): void {
    this.#shown = true;
    for (const feed of this.#feeds.values()) feed.start();
    this.#stopRates ??= this.#model.rates.watch(() => this.#refresh());
    this.#make();
  }

  hide(): void {
    this.#shown = false;
    for (const feed of this.#feeds.values()) feed.stop();
    this.#stopRates?.();
    this.#stopRates = undefined;
  }

  get #throttle(): number {
    return Number(this.#window.value) > 120 ? LONG_THROTTLE : THROTTLE;
  }

  #remove(row: Row): void {
    this.#rows.splice(this.#rows.indexOf(row), 1);
    this.#full = false;
    if (row.feed.remove(row.curve)) this.#feeds.delete(row.feed.topic);
    this.#make();
  }

  #removeAll(): void {
    for (const row of [...this.#rows]) this.#remove(row);
  }

  #clear(): void {
    for (const { curve } of this.#rows) curve.ring.clear();
    if (this.#pausedAt !== undefined) this.#toggle();
    this.#refresh();
  }

  #toggle(): void {
    this.#pausedAt = this.#pausedAt === undefined ? Date.now() / 1000 : undefined;
    this.#pause.classList.toggle("on", this.#pausedAt !== undefined);
    say(this.#pause, this.#pausedAt === undefined ? "Pause" : "Go on");
    this.#refresh();
  }

  /** Make room, without losing the curves. */
  #toggleFold(): void {
    const folded = this.element.classList.toggle("plot-folded");
    this.#fold.setAttribute("aria-expanded", String(!folded));
    this.#refresh();
  }

  #rewind(): void {
    for (const feed of this.#feeds.values()) feed.throttle = this.#throttle;
    this.#refresh();
  }

  /** The picture from the start: other curves, other colours, or another scale. */
  #make(): void {
    const any = this.#rows.length > 0;
    this.element.classList.toggle("plot-empty", !any);
    this.#hint.hidden = any;
    this.#fold.disabled = !any;
    this.#tools.hidden = !any;
    replace(this.#legend, ...this.#rows.map(({ entry }) => entry.element));
    if (!this.element.isConnected) return;
    const { color, borderTopColor } = getComputedStyle(this.#notes);
    const looks = this.#rows.map(({ entry: { style, colour } }) => ({ style, colour }));
    this.#chart.make(looks, { ink: color, line: borderTopColor }, this.#log.checked);
    this.#refresh();
  }

  /** Draw soon. A frame is asked for only then, since each costs something with nothing in it. */
  #refresh(): void {
    if (!this.#shown || this.#due) return;
    this.#due = true;
    const pause = this.#rows.length > FEW ? LONG_FRAME : FRAME;
    const draw = (now: number) => {
      this.#due = false;
      this.#drawn = now;
      this.#draw();
      // Time moves on, whether or not something came.
      if (this.#rows.length > 0 && this.#pausedAt === undefined) this.#refresh();
    };
    const rest = this.#drawn + pause - performance.now();
    setTimeout(() => requestAnimationFrame(draw), Math.max(0, rest));
  }

  #draw(): void {
    const now = this.#pausedAt ?? Date.now() / 1000;
    const first = Math.min(now, ...this.#rows.map(({ curve }) => curve.ring.first ?? now));
    const from = Math.max(now - Number(this.#window.value), Math.min(first, now - SHORTEST));
    // Every curve has a row for each sample of every other, so that the cost is their product.
    const most = Math.max(FEWEST, MOST / this.#rows.length);
    const curves = this.#rows.map(({ curve }) => curve.ring.between(from, now, most));
    this.#chart.show(curves, from, now, this.#log.checked);
    const time = this.#pointed ?? this.#pausedAt;
    for (const { curve, entry } of this.#rows)
      entry.tell(time === undefined ? curve.ring.newest : curve.ring.valueAt(time));
    this.#note(
      this.#log.checked && notPositive(curves) > 0
        ? ["Values of zero and below have no place on a logarithmic axis."]
        : [],
    );
  }

  #note(notes: string[]): void {
    const all = [...notes];
    if (this.#full) all.push(`${STYLES} curves are the most at once: take one away first.`);
    for (const { topic, refusal, odd } of this.#feeds.values()) {
      if (refusal !== "") all.push(`${topic}: ${refusal}`);
      if (odd !== "") all.push(`${topic} has no number at ${odd} now.`);
      const rate = this.#model.rates.value.topics.get(topic)?.messages ?? 0;
      const most = 1000 / this.#throttle;
      if (rate > 1.1 * most)
        all.push(`${topic} has ${hertz(rate)}; ${hertz(most)} of these are plotted.`);
    }
    say(this.#notes, all.join(" "));
  }

  #point(time: number | undefined): void {
    if (time === this.#pointed) return;
    this.#pointed = time;
    this.#refresh();
  }
}
