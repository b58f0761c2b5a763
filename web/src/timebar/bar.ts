/** The bar at the bottom of the page: pauses all panels, and shows them as they were at a moment. */
import { clockText } from "../bags/clock_text";
import type { Clock } from "../clock";
import { h, replace, setAttribute, setText } from "../dom";
import { bytes, timeOfDay } from "../format";
import type { DataClient } from "../messages/data_client";
import type { Command } from "../messages/player";
import type { Model } from "../model";
import "./bar.css";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 50];
/** Steps of the bar for the arrow keys. */
const STEPS = 1000;
/** Most topics that are offered. */
const MAX_TOPICS = 500;

export class TimeBar {
  readonly element: HTMLElement;
  readonly #clock: Clock;
  readonly #data: DataClient;
  readonly #isFile: boolean;
  readonly #play = h("button", { type: "button", onclick: () => this.#toggle() }, "Pause all");
  readonly #live = h(
    "button",
    { type: "button", onclick: () => this.#send({ kind: "live" }) },
    "Live",
  );
  readonly #bar = h("input", {
    type: "range",
    "aria-label": "Time",
    min: 0,
    max: 0,
    value: 0,
    oninput: () => this.#seek(),
  });
  readonly #time = h("output", { class: "timebar-time mono" });
  readonly #kept = h("span", { class: "timebar-kept soft small" });
  readonly #speed = h(
    "select",
    { "aria-label": "Speed", onchange: () => this.#playOn() },
    ...SPEEDS.map((each) => h("option", { value: each }, `${each}×`)),
  );
  readonly #loop = h("input", { type: "checkbox", onchange: () => this.#playOn() });
  readonly #topic = h("select", { class: "mono", "aria-label": "Topic of the steps" });
  readonly #find = h("input", {
    type: "search",
    class: "timebar-find",
    placeholder: "find",
    "aria-label": "Find the next message with a text or a number",
    title: "Enter: the next message of the topic that has this text or number",
    onkeydown: ({ key }: KeyboardEvent) => {
      const text = this.#find.value.trim();
      if (key === "Enter" && text !== "")
        this.#send({ kind: "find", topic: this.#topic.value, text });
    },
  });
  readonly #found = h("span", { class: "soft small", role: "status" });
  readonly #steps: HTMLElement;
  #frame: number | undefined;

  /** `isFile`: nothing comes but what is recorded. */
  constructor(clock: Clock, data: DataClient, model: Model, isFile: boolean) {
    this.#clock = clock;
    this.#data = data;
    this.#isFile = isFile;
    const step = (by: 1 | -1): void => this.#send({ kind: "step", topic: this.#topic.value, by });
    const stepButton = (by: 1 | -1, label: string, text: string) =>
      h(
        "button",
        { type: "button", "aria-label": label, title: label, onclick: () => step(by) },
        text,
      );
    this.#speed.value = "1";
    this.#steps = h(
      "span",
      { class: "timebar-steps" },
      stepButton(-1, "Previous message", "‹"),
      stepButton(1, "Next message", "›"),
      this.#topic,
      this.#find,
      this.#found,
      this.#speed,
      isFile ? h("label", {}, this.#loop, " loop") : "",
    );
    this.element = h(
      "footer",
      { id: "timebar", "aria-label": "Time" },
      this.#play,
      this.#live,
      this.#bar,
      this.#time,
      this.#steps,
      this.#kept,
    );
    model.graph.watch((graph) => this.#offer(graph?.topics.map(({ name }) => name) ?? []));
    clock.playback.watch(() => this.#show());
  }

  #send(command: Command): void {
    this.#data.send({ kind: "playback", command });
  }

  #toggle(): void {
    const { isLive, speed } = this.#clock.playback.value;
    if (isLive || speed > 0) this.#send({ kind: "pause" });
    else this.#sendPlay();
  }

  #sendPlay(): void {
    this.#send({ kind: "play", speed: Number(this.#speed.value), loop: this.#loop.checked });
  }

  /** Go on with another speed, if it plays. */
  #playOn(): void {
    const { isLive, speed } = this.#clock.playback.value;
    if (!isLive && speed > 0) this.#sendPlay();
  }

  #seek(): void {
    this.#send({ kind: "seek", time: Number(this.#bar.value) });
  }

  #offer(names: readonly string[]): void {
    const all = [...new Set(names)].sort().slice(0, MAX_TOPICS);
    if (all.length + 1 === this.#topic.options.length) return;
    const chosen = this.#topic.value;
    replace(
      this.#topic,
      h("option", { value: "" }, "any topic"),
      ...all.map((value) => h("option", { value }, value)),
    );
    this.#topic.value = all.includes(chosen) ? chosen : "";
  }

  /** Show the time, and again while it passes. */
  #show(): void {
    if (this.#frame !== undefined) cancelAnimationFrame(this.#frame);
    this.#frame = undefined;
    const { isLive, speed, start, end, bytes: memory, search = "" } = this.#clock.playback.value;
    setText(this.#found, search === "searching" ? "searching …" : search);
    const now = isLive ? end : this.#clock.now();
    const isPlaying = isLive || speed > 0;
    setText(this.#play, isPlaying ? "Pause all" : "Play");
    this.element.dataset.state = isLive ? "live" : isPlaying ? "playing" : "paused";
    this.#live.hidden = this.#isFile;
    this.#live.disabled = isLive;
    this.#steps.hidden = isLive;
    Object.assign(this.#bar, { min: start, max: end, step: Math.max(1, (end - start) / STEPS) });
    // Exactly where it is: steps are for keys.
    if (isPlaying || document.activeElement !== this.#bar) this.#bar.value = String(now);
    const text = isLive ? "live" : this.#text(now, start);
    setText(this.#time, text);
    setAttribute(this.#bar, "aria-valuetext", text);
    const length = clockText((end - start) / 1000);
    setText(this.#kept, this.#isFile ? `of ${length}` : `${length} kept, ${bytes(memory)}`);
    if (!isLive && speed > 0) this.#frame = requestAnimationFrame(() => this.#show());
  }

  #text(now: number, start: number): string {
    const seconds = now / 1000;
    const part = String(Math.floor(now % 1000)).padStart(3, "0");
    const time = `${timeOfDay(seconds)}.${part}`;
    return this.#isFile ? `${time} · ${clockText((now - start) / 1000)}` : time;
  }
}
