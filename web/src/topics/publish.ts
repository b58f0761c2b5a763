/** Publish on a topic through a form: once, or again and again. */
import { h, say } from "../dom";
import { MessageForm } from "../form/form";
import { plural } from "../format";
import type { Hub, Publication } from "../hub";
import type { Types } from "../types";

/** Messages a second that a browser's timer can keep up with. */
const FASTEST = 100;

export class Publish {
  readonly element: HTMLFormElement;
  readonly #hub: Hub;
  readonly #topic: string;
  readonly #type: string;
  readonly #form: MessageForm;
  readonly #rate: HTMLInputElement;
  readonly #repeat: HTMLButtonElement;
  readonly #said = h("span", { class: "soft small", role: "status" });
  readonly #refusal = h("p", { class: "error", role: "alert", hidden: true });
  #publication: Publication | undefined;
  #count = 0;
  #timer: number | undefined;

  constructor(hub: Hub, topic: string, type: string, types: Types) {
    this.#hub = hub;
    this.#topic = topic;
    this.#type = type;
    this.#form = new MessageForm(types, type);
    this.#rate = h("input", {
      type: "number",
      class: "publish-rate",
      min: 0.1,
      max: FASTEST,
      step: "any",
      value: "1",
      "aria-label": "Messages a second",
    });
    this.#repeat = h("button", { type: "button", onclick: () => this.#toggle() }, "Repeat");
    this.element = h(
      "form",
      // The fields have words of their own for what is wrong.
      {
        class: "publish",
        novalidate: true,
        "aria-label": `Publish on ${topic}`,
        onsubmit: (event: Event) => {
          event.preventDefault();
          this.#publish();
        },
      },
      this.#form.element,
      h(
        "div",
        { class: "toolbar" },
        h("button", { type: "submit", class: "primary" }, "Publish"),
        h("span", { class: "publish-repeat" }, this.#repeat, this.#rate, "Hz"),
        this.#said,
      ),
      this.#refusal,
    );
  }

  /** Stop publishing, and be the topic's publisher no more. */
  close(): void {
    this.#stop();
    this.#publication?.close();
    this.#publication = undefined;
  }

  /** Tells whether a message went out. */
  #publish(): boolean {
    const message = this.#form.read();
    if (message === undefined) return false;
    this.#refusal.hidden = true;
    this.#publication ??= this.#hub.advertise(this.#topic, this.#type, (why) => this.#refuse(why));
    this.#count += 1;
    say(this.#said, `${plural(this.#count, "message")} published`);
    this.#publication.publish(message);
    return this.#refusal.hidden;
  }

  #refuse(why: string): void {
    this.#stop();
    say(this.#refusal, why);
    this.#refusal.hidden = false;
    say(this.#said, "");
    this.#count = 0;
  }

  #toggle(): void {
    if (this.#timer !== undefined) {
      this.#stop();
      return;
    }
    const rate = Number(this.#rate.value);
    if (!(rate >= 0.1 && rate <= FASTEST)) {
      this.#rate.setAttribute("aria-invalid", "true");
      this.#refuse(`The rate is from 0.1 to ${FASTEST} Hz.`);
      return;
    }
    this.#rate.removeAttribute("aria-invalid");
    if (!this.#publish()) return;
    this.#timer = window.setInterval(() => {
      // What is written now counts; once it is wrong, it is not guessed at.
      if (!this.#publish()) this.#stop();
    }, 1000 / rate);
    this.#repeat.classList.add("on");
    this.#rate.disabled = true;
    say(this.#repeat, "Stop");
  }

  #stop(): void {
    window.clearInterval(this.#timer);
    this.#timer = undefined;
    this.#repeat.classList.remove("on");
    this.#rate.disabled = false;
    say(this.#repeat, "Repeat");
  }
}
