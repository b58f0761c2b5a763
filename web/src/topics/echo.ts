/** The newest message of a topic, until one pauses to read it. */
import { copyButton } from "../copy";
import { h, say } from "../dom";
import { ago, plural } from "../format";
import type { Hub, Message } from "../hub";
import type { PlotPath } from "../tree/leaf";
import { Tree } from "../tree/tree";
import type { Types } from "../types";

/** Least time between two messages, in ms. */
const THROTTLE = 100;
/** Time between two looks at the clock, in ms. */
const TICK = 500;

export class Echo {
  readonly element: HTMLElement;
  readonly #hub: Hub;
  readonly #topic: string;
  readonly #tree: Tree;
  readonly #pause: HTMLButtonElement;
  readonly #copy: HTMLButtonElement;
  readonly #count = h("span", { class: "echo-count end small soft" });
  readonly #waiting = h("p", { class: "soft" }, "No message yet.");
  readonly #refusal = h("p", { class: "error", role: "alert", hidden: true });
  #paused = false;
  #shown = false;
  #heard = 0;
  #at = 0;
  #newest: Message | undefined;
  #stop: (() => void) | undefined;
  #timer: number | undefined;

  constructor(hub: Hub, topic: string, type: string, types: Types | undefined, plot: PlotPath) {
    this.#hub = hub;
    this.#topic = topic;
    this.#tree = new Tree(types, type, plot);
    this.#tree.element.hidden = true;
    this.#pause = h(
      "button",
      {
        type: "button",
        class: "echo-pause",
        title: "Key: space",
        onclick: () => this.#toggle(),
      },
      "Pause",
    );
    this.#copy = copyButton("Copy as JSON", () => JSON.stringify(this.#newest, null, 2));
    this.#copy.disabled = true;
    this.element = h(
      "div",
      {
        class: "echo",
        tabindex: 0,
        role: "group",
        "aria-label": `Newest message of ${topic}; space pauses`,
        onkeydown: (event: KeyboardEvent) => this.#key(event),
      },
      h("div", { class: "toolbar" }, this.#pause, this.#copy, this.#count),
      this.#refusal,
      this.#waiting,
      this.#tree.element,
    );
    this.#tell();
  }

  /** Comes into sight. */
  show(): void {
    this.#shown = true;
    this.#listen();
  }

  /** Goes out of sight. */
  hide(): void {
    this.#shown = false;
    this.#listen();
  }

  /** What is paused or out of sight is not subscribed to. */
  #listen(): void {
    if (this.#shown && !this.#paused) {
      this.#stop ??= this.#hub.subscribe(
        this.#topic,
        { throttle: THROTTLE, queue: 1 },
        (message) => this.#hear(message),
        (why) => this.#refuse(why),
      );
    } else {
      this.#stop?.();
      this.#stop = undefined;
    }
    window.clearInterval(this.#timer);
    if (this.#shown) this.#timer = window.setInterval(() => this.#tell(), TICK);
  }

  #hear(message: Message): void {
    this.#heard += 1;
    this.#at = performance.now();
    this.#newest = message;
    this.#refusal.hidden = true;
    this.#waiting.hidden = true;
    this.#tree.element.hidden = false;
    this.#copy.disabled = false;
    this.#tree.show(message);
    this.#tell();
  }

  #refuse(why: string): void {
    say(this.#refusal, why);
    this.#refusal.hidden = false;
  }

  #toggle(): void {
    this.#paused = !this.#paused;
    this.#pause.classList.toggle("on", this.#paused);
    say(this.#pause, this.#paused ? "Go on" : "Pause");
    this.#listen();
    this.#tell();
  }

  #key(event: KeyboardEvent): void {
    // Space on a button or on a fold means that.
    const own = event.target === this.element;
    if (event.key !== " " || !own || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (!event.repeat) this.#toggle();
  }

  #tell(): void {
    const parts = [`${plural(this.#heard, "message")} shown`];
    if (this.#paused) parts.unshift("paused");
    if (this.#heard > 0) parts.push(`newest ${ago((performance.now() - this.#at) / 1000)}`);
    say(this.#count, parts.join(" · "));
  }
}
