/** A form to publish on a topic, once or repeatedly. */
import { h, setText } from "../dom";
import { MessageForm } from "../form/message_form";
import { plural } from "../format";
import type { Publication } from "../hub";
import type { DataSource } from "../source";
import type { Types } from "../types";

/** The highest rate, in Hz, that a timer in a browser can keep. */
const MAX_RATE = 100;

export class PublishForm {
  readonly element: HTMLFormElement;
  readonly #hub: DataSource;
  readonly #topic: string;
  readonly #type: string;
  readonly #form: MessageForm;
  readonly #rate: HTMLInputElement;
  readonly #repeat: HTMLButtonElement;
  readonly #status = h("span", { class: "soft small", role: "status" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  #publication: Publication | undefined;
  #count = 0;
  #timer: number | undefined;

  constructor(hub: DataSource, topic: string, type: string, types: Types) {
    this.#hub = hub;
    this.#topic = topic;
    this.#type = type;
    this.#form = new MessageForm(types, type);
    this.#rate = h("input", {
      type: "number",
      class: "publish-rate",
      min: 0.1,
      max: MAX_RATE,
      step: "any",
      value: "1",
      "aria-label": "Messages a second",
    });
    this.#repeat = h("button", { type: "button", onclick: () => this.#toggle() }, "Repeat");
    this.element = h(
      "form",
      // Not validated by the browser: the fields show their own problems.
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
        this.#status,
      ),
      this.#error,
    );
  }

  /** Stop publishing and unadvertise the topic. */
  close(): void {
    this.#stop();
    this.#publication?.close();
    this.#publication = undefined;
  }

  /** Publish the message in the form; returns whether that succeeded. */
  #publish(): boolean {
    const message = this.#form.read();
    if (message === undefined) return false;
    this.#error.hidden = true;
    this.#publication ??= this.#hub.advertise(this.#topic, this.#type, (why) =>
      this.#showError(why),
    );
    this.#count += 1;
    setText(this.#status, `${plural(this.#count, "message")} published`);
    this.#publication.publish(message);
    return this.#error.hidden;
  }

  #showError(why: string): void {
    this.#stop();
    setText(this.#error, why);
    this.#error.hidden = false;
    setText(this.#status, "");
    this.#count = 0;
  }

  #toggle(): void {
    if (this.#timer !== undefined) {
      this.#stop();
      return;
    }
    const rate = Number(this.#rate.value);
    if (!(rate >= 0.1 && rate <= MAX_RATE)) {
      this.#rate.setAttribute("aria-invalid", "true");
      this.#showError(`The rate must be between 0.1 and ${MAX_RATE} Hz.`);
      return;
    }
    this.#rate.removeAttribute("aria-invalid");
    if (!this.#publish()) return;
    this.#timer = window.setInterval(() => {
      // The form is read each time; an invalid value ends the repetition.
      if (!this.#publish()) this.#stop();
    }, 1000 / rate);
    this.#repeat.classList.add("on");
    this.#rate.disabled = true;
    setText(this.#repeat, "Stop");
  }

  #stop(): void {
    window.clearInterval(this.#timer);
    this.#timer = undefined;
    this.#repeat.classList.remove("on");
    this.#rate.disabled = false;
    setText(this.#repeat, "Repeat");
  }
}
