/** Shows the newest message of a topic, and can be paused. */
import { copyButton } from "../copy_button";
import { h, setText } from "../dom";
import { ago, plural } from "../format";
import type { Message } from "../hub";
import { MessageTree, type PlotPath } from "../message_tree";
import { subscribe } from "../messages/data_client";
import { jsonText } from "../messages/values";
import type { DataSource } from "../source";
import type { Types } from "../types";
import "./echo.css";

/** Minimum time between two messages, in ms. */
const THROTTLE = 100;
/** Time between two updates of the newest message's age, in ms. */
const TICK = 500;

export class Echo {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #topic: string;
  readonly #tree: MessageTree;
  readonly #pause: HTMLButtonElement;
  readonly #copy: HTMLButtonElement;
  readonly #count = h("span", { class: "echo-count end small soft" });
  readonly #waiting = h("p", { class: "soft" }, "No message yet.");
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  #paused = false;
  #shown = false;
  #received = 0;
  #lastTime = 0;
  #newest: Message | undefined;
  #stop: (() => void) | undefined;
  #timer: number | undefined;

  constructor(
    hub: DataSource,
    topic: string,
    type: string,
    types: Types | undefined,
    plot: PlotPath,
  ) {
    this.#hub = hub;
    this.#topic = topic;
    this.#tree = new MessageTree(types, type, plot, topic);
    this.#tree.element.hidden = true;
    this.#pause = h(
      "button",
      {
        type: "button",
        class: "echo-pause",
        title: "Space",
        onclick: () => this.#toggle(),
      },
      "Pause",
    );
    this.#copy = copyButton("Copy as JSON", () => jsonText(this.#newest));
    this.#copy.disabled = true;
    this.element = h(
      "div",
      {
        class: "echo",
        tabindex: 0,
        role: "group",
        "aria-label": `Newest message of ${topic}; space pauses`,
        onkeydown: (event: KeyboardEvent) => this.#onKey(event),
      },
      h("div", { class: "toolbar" }, this.#pause, this.#copy, this.#count),
      this.#error,
      this.#waiting,
      this.#tree.element,
    );
    this.#showStatus();
  }

  /** The echo becomes visible. */
  show(): void {
    this.#shown = true;
    this.#updateSubscription();
  }

  /** The echo becomes hidden. */
  hide(): void {
    this.#shown = false;
    this.#updateSubscription();
  }

  get newest(): Message | undefined {
    return this.#newest;
  }

  /** Subscribe while visible and not paused. */
  #updateSubscription(): void {
    if (this.#shown && !this.#paused) {
      if (this.#stop === undefined) {
        const stops = [
          this.#hub.clock.onJump(() => this.#clear()),
          subscribe(
            this.#hub,
            { topic: this.#topic, throttle: THROTTLE },
            (message, { time }) => this.#receive(message, time),
            (why) => this.#showError(why),
          ),
        ];
        this.#stop = () => {
          for (const stop of stops) stop();
        };
      }
    } else {
      this.#stop?.();
      this.#stop = undefined;
    }
    window.clearInterval(this.#timer);
    if (this.#shown) this.#timer = window.setInterval(() => this.#showStatus(), TICK);
  }

  /** Time has jumped: show nothing until there is a message of then. */
  #clear(): void {
    this.#newest = undefined;
    this.#waiting.hidden = false;
    this.#tree.element.hidden = true;
    this.#copy.disabled = true;
  }

  #receive(message: Message, time: number): void {
    this.#received += 1;
    this.#lastTime = time;
    this.#newest = message;
    this.#error.hidden = true;
    this.#waiting.hidden = true;
    this.#tree.element.hidden = false;
    this.#copy.disabled = false;
    this.#tree.show(message);
    this.#showStatus();
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = why === "";
  }

  #toggle(): void {
    this.#paused = !this.#paused;
    this.#pause.classList.toggle("on", this.#paused);
    setText(this.#pause, this.#paused ? "Resume" : "Pause");
    this.#updateSubscription();
    this.#showStatus();
  }

  #onKey(event: KeyboardEvent): void {
    // Space on a button or a fold in it has its own effect.
    const isHere = event.target === this.element;
    if (event.key !== " " || !isHere || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (!event.repeat) this.#toggle();
  }

  #showStatus(): void {
    const parts = [`${plural(this.#received, "message")} shown`];
    if (this.#paused) parts.unshift("paused");
    if (this.#newest !== undefined)
      parts.push(`newest ${ago(Math.max(0, this.#hub.clock.now() - this.#lastTime) / 1000)}`);
    setText(this.#count, parts.join(" · "));
  }
}
