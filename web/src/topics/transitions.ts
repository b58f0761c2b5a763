/** The states of fields over time, as coloured spans: booleans, texts, and integers with constants. */
import { h, replace, setName, setText } from "../dom";
import { least } from "../lists";
import type { Model } from "../model";
import type { DataSource } from "../source";
import { agoText, clock, type Extent, multiples, spanFor, timeStep } from "./axes";
import { listen } from "./gestures";
import { curvesFrom, curvesText, ranges, type ViewState } from "./plot_state";
import { type Recorder, Sampler } from "./sampler";
import { sharedCursor } from "./shared_cursor";
import { spansOf } from "./state_spans";
import { StateTrack } from "./state_track";
import "./plot.css";
import "./transitions.css";

/** Time between two frames while nothing is under the mouse, in ms. */
const FRAME = 200;
/** The shortest time that can be seen, in seconds. */
const MIN_SPAN = 1e-3;
const FONT = "11px system-ui, sans-serif";
/** The number of colours, those of plots. */
const COLOURS = 8;
/** The space around a text within a span, and that of a label of the time axis. In CSS pixels. */
const GAP = 5;
const LABEL_WIDTH = 84;

interface Row {
  readonly track: StateTrack;
  readonly sampler: Sampler;
  readonly element: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  readonly name: HTMLElement;
  readonly value: HTMLElement;
}

export class Transitions {
  readonly element: HTMLElement;
  readonly #source: DataSource;
  readonly #model: Model;
  readonly #changed: () => void;
  readonly #aborter = new AbortController();
  readonly #samplers = new Map<string, Sampler>();
  readonly #rows: Row[] = [];
  readonly #list = h("ul", { class: "transitions-rows", "aria-label": "States" });
  readonly #times = h("canvas", { class: "transitions-times", "aria-hidden": "true" });
  readonly #notes = h("p", { class: "small soft", "aria-live": "polite" });
  readonly #range: HTMLSelectElement;
  readonly #pause: HTMLButtonElement;
  readonly #reset: HTMLButtonElement;
  #colours: readonly string[] = [];
  #ink = "";
  /** Of the texts on the spans. */
  #textColour = "";
  #pausedAt: number | undefined;
  /** What the user has zoomed to. */
  #view: Extent | undefined;
  #shown = false;
  #timer: number | undefined;
  #isDrawing = false;
  #lastDraw = -Infinity;
  #stopCursor: (() => void) | undefined;

  /** `changed` is called when the state changes that belongs into layouts. */
  constructor(hub: DataSource, model: Model, changed: () => void) {
    this.#source = hub;
    this.#model = model;
    this.#changed = changed;
    const { signal } = this.#aborter;
    const button = (text: string, onclick: () => void) =>
      h("button", { type: "button", onclick }, text);
    this.#range = h(
      "select",
      { "aria-label": "Time range", onchange: () => this.#update() },
      ...ranges.all.map(({ seconds, label }) => h("option", { value: seconds }, label)),
    );
    this.#range.value = ranges.usual;
    this.#pause = button("Pause", () => this.#togglePause());
    this.#reset = button("Show all", () => this.#show(undefined));
    const place = h(
      "div",
      {
        class: "transitions-place",
        tabindex: 0,
        role: "group",
        "aria-label": "States over time: wheel to zoom, Shift and drag to move; Escape shows all",
      },
      this.#list,
      this.#times,
    );
    this.element = h(
      "section",
      { class: "transitions", "aria-label": "State transitions" },
      h("div", { class: "toolbar" }, this.#reset, this.#range, this.#pause),
      place,
      this.#notes,
    );
    const gestures = {
      pan: (dx: number): void => this.#move(-dx, this.#width - dx),
      zoom: (factor: number, x = this.#width / 2): void =>
        this.#move(x - x * factor, x + (this.#width - x) * factor),
      reset: (): void => this.#show(undefined),
    };
    listen(place, place, gestures, signal);
    const point = ({ clientX }: PointerEvent): void =>
      sharedCursor.set(this.#timeAt(clientX - this.#times.getBoundingClientRect().left));
    place.addEventListener("pointermove", point, { signal });
    place.addEventListener("pointerleave", () => sharedCursor.set(undefined), { signal });
    const restyle = (): void => this.#restyle();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle, { signal });
    const observer = new ResizeObserver(() => this.#refresh());
    observer.observe(place);
    signal.addEventListener("abort", () => observer.disconnect());
  }

  /** Add the states of a field, unless they are shown already. */
  async add(topic: string, path: string): Promise<void> {
    const type = this.#model.graph.value?.topics.find(({ name }) => name === topic)?.type;
    const typedefs = type ? await this.#model.typedefs(type).catch(() => []) : [];
    if (this.#aborter.signal.aborted) return;
    const track = new StateTrack(path, typedefs);
    if (track.path === "") {
      setText(this.#notes, `“${path}” is not a field; expected one such as status.level.`);
      return;
    }
    const sampler = this.#samplerOf(topic);
    sampler.add(track);
    const isThere = this.#rows.some(
      (row) => row.sampler === sampler && row.track.path === track.path,
    );
    if (isThere) sampler.remove(track);
    else this.#rows.push(this.#makeRow(track, sampler));
    this.#update();
  }

  show(state: URLSearchParams | null): void {
    this.#shown = true;
    if (state !== null) this.#restore(state);
    for (const sampler of this.#samplers.values()) sampler.start();
    this.#stopCursor ??= sharedCursor.watch(() => this.#refresh());
    this.#restyle();
  }

  hide(): void {
    this.#shown = false;
    window.clearTimeout(this.#timer);
    for (const sampler of this.#samplers.values()) sampler.stop();
    this.#stopCursor?.();
    this.#stopCursor = undefined;
  }

  /** Free what it has: it is not shown again. */
  close(): void {
    this.hide();
    this.#aborter.abort();
    this.#rows.length = 0;
    this.#samplers.clear();
  }

  get state(): ViewState {
    if (this.#rows.length === 0) return {};
    return {
      states: curvesText(this.#rows.map(({ sampler, track }) => [sampler.topic, track.path])),
      range: this.#range.value === ranges.usual ? "" : this.#range.value,
    };
  }

  #restore(state: URLSearchParams): void {
    const range = state.get("range");
    if (ranges.all.some(({ seconds }) => String(seconds) === range))
      this.#range.value = range ?? "";
    // In their order, though each waits for its type.
    void (async () => {
      for (const [topic, path] of curvesFrom(state.get("states") ?? ""))
        await this.add(topic, path);
    })();
  }

  #samplerOf(topic: string): Sampler {
    let sampler = this.#samplers.get(topic);
    if (sampler === undefined) {
      const remove = (twin: Recorder): void => {
        const row = this.#rows.find(({ track }) => track === twin);
        if (row !== undefined) this.#remove(row);
      };
      sampler = new Sampler(this.#source, topic, () => this.#refresh(), remove);
      this.#samplers.set(topic, sampler);
      sampler.reach(Number(this.#range.value));
      if (this.#shown) sampler.start();
    }
    return sampler;
  }

  #makeRow(track: StateTrack, sampler: Sampler): Row {
    const remove = (): void => this.#remove(row);
    const name = h("span", { class: "mono small" });
    const value = h("output", {}, "–");
    const canvas = h("canvas", { role: "img" });
    const label = `Remove ${sampler.topic} ${track.path}`;
    const element = h(
      "li",
      {},
      h(
        "div",
        { class: "transitions-head" },
        name,
        value,
        h(
          "button",
          { type: "button", class: "quiet plot-remove", "aria-label": label, onclick: remove },
          "×",
        ),
      ),
      canvas,
    );
    const row: Row = { track, sampler, element, canvas, name, value };
    return row;
  }

  #remove(row: Row): void {
    const { sampler, track } = row;
    this.#rows.splice(this.#rows.indexOf(row), 1);
    if (sampler.remove(track)) this.#samplers.delete(sampler.topic);
    this.#update();
  }

  // Time.

  get #now(): number {
    return this.#pausedAt ?? this.#source.clock.now() / 1000;
  }

  /** What is seen. */
  get #seen(): Extent {
    if (this.#view !== undefined) return this.#view;
    const now = this.#now;
    const first = least(
      this.#rows.map(({ track }) => track.changes[0]?.time ?? now),
      now,
    );
    return [now - spanFor(now - first, Number(this.#range.value)), now];
  }

  get #width(): number {
    return Math.max(1, this.#times.clientWidth);
  }

  #timeAt(x: number): number {
    const [from, to] = this.#seen;
    return from + (x / this.#width) * (to - from);
  }

  #move(left: number, right: number): void {
    const [from, to] = [this.#timeAt(left), this.#timeAt(right)];
    if (to - from > MIN_SPAN) this.#show([from, to]);
  }

  #show(view: Extent | undefined): void {
    this.#view = view;
    this.#refresh();
  }

  #togglePause(): void {
    this.#pausedAt = this.#pausedAt === undefined ? this.#source.clock.now() / 1000 : undefined;
    this.#pause.classList.toggle("on", this.#pausedAt !== undefined);
    setText(this.#pause, this.#pausedAt === undefined ? "Pause" : "Resume");
    this.#refresh();
  }

  // What is on the screen.

  #update(): void {
    replace(this.#list, ...this.#rows.map(({ element }) => element));
    for (const sampler of this.#samplers.values()) sampler.reach(Number(this.#range.value));
    this.#refresh();
    this.#changed();
  }

  #restyle(): void {
    const style = getComputedStyle(this.element);
    this.#ink = style.color;
    // The colours of plots depend on the colour scheme, which only elements know.
    const probe = h("span", { class: "plot", hidden: true });
    this.element.append(probe);
    this.#colours = Array.from({ length: COLOURS }, (_, at) => {
      probe.className = `plot curve-${at}`;
      return getComputedStyle(probe).color;
    });
    probe.className = "transitions-text";
    this.#textColour = getComputedStyle(probe).color;
    probe.remove();
    this.#refresh();
  }

  /** Draw in the next frame. */
  #refresh(): void {
    if (!this.#shown || this.#isDrawing) return;
    this.#isDrawing = true;
    window.clearTimeout(this.#timer);
    const since = performance.now() - this.#lastDraw;
    const wait = sharedCursor.value === undefined ? Math.max(0, FRAME - since) : 0;
    this.#timer = window.setTimeout(() => requestAnimationFrame(() => this.#draw()), wait);
  }

  #draw(): void {
    this.#isDrawing = false;
    if (!this.#shown) return;
    this.#lastDraw = performance.now();
    const seen = this.#seen;
    const pointed = sharedCursor.value;
    const time = pointed ?? this.#pausedAt;
    for (const { track, sampler, canvas, name, value } of this.#rows) {
      setName(name, `${sampler.topic} ${track.path}`);
      setText(value, (time === undefined ? track.newest : track.at(time)) ?? "–");
      canvas.setAttribute("aria-label", `States of ${sampler.topic} ${track.path}`);
      this.#drawRow(track, canvas, seen, pointed);
    }
    this.#drawTimes(seen);
    this.#reset.hidden = this.#view === undefined;
    this.#showNotes(pointed);
    // The time moves even without messages.
    const isStill = this.#view !== undefined || this.#pausedAt !== undefined;
    if (this.#rows.length > 0 && !isStill) {
      this.#timer = window.setTimeout(() => this.#draw(), FRAME);
    }
  }

  #drawRow(
    track: StateTrack,
    canvas: HTMLCanvasElement,
    [from, to]: Extent,
    pointed?: number,
  ): void {
    const [context, width, height] = begin(canvas);
    const until = Math.min(to, this.#now);
    const pixels = Math.max(
      1,
      Math.round(((until - from) / (to - from)) * width * devicePixelRatio),
    );
    const scale = devicePixelRatio;
    context.font = FONT;
    context.textBaseline = "middle";
    for (const { left, right, state, colour } of spansOf(track, from, until, pixels)) {
      const [x, wide] = [left / scale, (right - left) / scale];
      context.fillStyle = this.#colours[colour % COLOURS] ?? this.#ink;
      context.fillRect(x, 0, wide, height);
      if (wide < 4 * GAP) continue;
      context.save();
      context.beginPath();
      context.rect(x, 0, wide - GAP, height);
      context.clip();
      context.fillStyle = this.#textColour;
      context.fillText(state, x + GAP, height / 2);
      context.restore();
    }
    if (pointed === undefined || pointed < from || pointed > to) return;
    context.fillStyle = this.#ink;
    context.fillRect(((pointed - from) / (to - from)) * width, 0, 1, height);
  }

  #drawTimes(seen: Extent): void {
    const [context, width, height] = begin(this.#times);
    const isStill = this.#view !== undefined || this.#pausedAt !== undefined;
    const [from, to] = isStill ? seen : [seen[0] - seen[1], 0];
    const step = timeStep(to - from, Math.max(2, width / LABEL_WIDTH));
    const digits = step >= 1 ? 1 : Math.ceil(-Math.log10(step) - 1e-9);
    context.font = FONT;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = this.#ink;
    for (const time of multiples([from, to], step)) {
      const label = isStill ? clock(time, digits) : agoText(-time);
      const half = context.measureText(label).width / 2;
      const x = ((time - from) / (to - from)) * width;
      context.fillText(label, Math.min(width - half, Math.max(half, x)), height / 2);
    }
  }

  #showNotes(pointed: number | undefined): void {
    const all = pointed === undefined ? [] : [`At ${clock(pointed, 3)}.`];
    for (const { topic, error, missing } of this.#samplers.values()) {
      if (error !== "") all.push(`${topic}: ${error}`);
      if (missing !== "") all.push(`${topic} has no state at ${missing} now.`);
    }
    if (all.length > 0 || this.#rows.length > 0) setText(this.#notes, all.join(" "));
  }
}

/** Clear a canvas, which gets as many pixels as the screen has there. */
function begin(
  canvas: HTMLCanvasElement,
): [context: CanvasRenderingContext2D, width: number, height: number] {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = Math.round(width * devicePixelRatio);
  canvas.height = Math.round(height * devicePixelRatio);
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  context.scale(devicePixelRatio, devicePixelRatio);
  return [context, width, height];
}
