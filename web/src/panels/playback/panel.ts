/** Shows how far a bag is played, and controls the player: `fibws bag play`. */
import "./playback.css";

import { clockText } from "../../bags/clock_text";
import { h, setText } from "../../dom";
import { dateTime } from "../../format";
import type { Message } from "../../hub";
import { subscribe } from "../../messages/data_client";
import type { Model, Time } from "../../model";
import type { DataSource } from "../../source";
import type { Panel } from "../panel";

/** A message of fibws_msgs/PlaybackState. */
interface PlaybackState {
  /** A key of `STATES`. */
  status: number;
  start: Time;
  end: Time;
  position: Time;
  rate: number;
  bags: string[];
}

const PAUSED = 2;
const STATES: Record<number, string> = { 1: "Playing", 2: "Paused", 3: "Delayed", 4: "Ended" };
const RATES = [0.1, 0.25, 0.5, 1, 2, 5, 10];
/** Steps of the slider. */
const STEPS = 1000;

export function makePanel(hub: DataSource, _model: Model, topic: string): Panel {
  return new PlaybackPanel(hub, topic);
}

class PlaybackPanel implements Panel {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #topic: string;
  readonly #state = h("p", { class: "playback-state", role: "status" }, "No message yet.");
  readonly #times = h("p", { class: "playback-times mono" });
  readonly #bags = h("p", { class: "soft" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #toggle = this.#button("Pause", () => this.#togglePause());
  readonly #step = this.#button("Step", () => this.#control({ command: "step" }));
  readonly #slider = h("input", {
    type: "range",
    class: "playback-position",
    min: 0,
    max: STEPS,
    "aria-label": "Position",
    disabled: true,
    onchange: () => this.#seek(),
  });
  readonly #rate: HTMLSelectElement = h(
    "select",
    {
      "aria-label": "Rate",
      disabled: true,
      onchange: () => this.#control({ command: "rate", rate: Number(this.#rate.value) }),
    },
    ...RATES.map((rate) => h("option", { value: rate }, `× ${rate}`)),
  );
  #last: PlaybackState | undefined;
  #stop: (() => void) | undefined;

  constructor(hub: DataSource, topic: string) {
    this.#hub = hub;
    this.#topic = topic;
    this.element = h(
      "div",
      { class: "playback" },
      h("div", { class: "toolbar" }, this.#toggle, this.#step, this.#rate, this.#state),
      this.#slider,
      this.#times,
      this.#bags,
      this.#error,
    );
  }

  show(): void {
    this.#stop ??= subscribe(
      this.#hub,
      { topic: this.#topic },
      (message) => this.#show(message as unknown as PlaybackState),
      (why) => this.#report(why),
    );
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
  }

  #button(text: string, act: () => void): HTMLButtonElement {
    return h("button", { type: "button", disabled: true, onclick: act }, text);
  }

  #show(state: PlaybackState): void {
    this.#last = state;
    for (const control of [this.#toggle, this.#slider, this.#rate]) control.disabled = false;
    this.#step.disabled = state.status !== PAUSED;
    setText(this.#toggle, state.status === PAUSED ? "Play" : "Pause");
    setText(this.#state, STATES[state.status] ?? "");
    const start = seconds(state.start);
    const [passed, whole] = [seconds(state.position) - start, seconds(state.end) - start];
    // A person who drags the slider must not lose it.
    if (!this.#slider.matches(":active")) {
      this.#slider.value = String(whole > 0 ? Math.round((passed / whole) * STEPS) : 0);
    }
    this.#slider.setAttribute("aria-valuetext", clockText(passed));
    const { secs, nsecs } = state.position;
    setText(this.#times, `${clockText(passed)} / ${clockText(whole)}   ${dateTime(secs, nsecs)}`);
    setText(this.#bags, state.bags.join(", "));
    this.#showRate(state.rate);
  }

  #showRate(rate: number): void {
    if (document.activeElement === this.#rate) return;
    const text = String(rate);
    if (![...this.#rate.options].some(({ value }) => value === text)) {
      this.#rate.append(h("option", { value: text }, `× ${text}`));
    }
    this.#rate.value = text;
  }

  #togglePause(): void {
    this.#control({ command: this.#last?.status === PAUSED ? "play" : "pause" });
  }

  #seek(): void {
    if (this.#last === undefined) return;
    const [start, end] = [seconds(this.#last.start), seconds(this.#last.end)];
    const time = start + ((end - start) * Number(this.#slider.value)) / STEPS;
    const secs = Math.floor(time);
    this.#control({
      command: "seek",
      position: { secs, nsecs: Math.floor((time - secs) * 1e9) },
    });
  }

  #control(request: Message): void {
    // The topic is ~playback, and the service ~control_playback.
    const service = this.#topic.replace(/playback$/, "control_playback");
    this.#hub
      .call<{ success: boolean; message: string }>(service, "fibws_msgs/ControlPlayback", request)
      .then(({ success, message }) => this.#report(success ? "" : message))
      .catch((error: unknown) => this.#report((error as Error).message));
  }

  #report(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = why === "";
  }
}

function seconds({ secs, nsecs }: Time): number {
  return secs + nsecs / 1e9;
}
