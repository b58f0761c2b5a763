/** Call a service: a form for its request, and the response as a tree. */
import { copyButton } from "../copy";
import { h, replace, say } from "../dom";
import { MessageForm } from "../form/form";
import type { Hub, Message } from "../hub";
import type { Model } from "../model";
import { Tree } from "../tree/tree";
import { Types } from "../types";
import { route } from "../view";

export class Call {
  readonly element: HTMLElement;
  readonly name: string;
  readonly type: string;
  readonly #hub: Hub;
  readonly #model: Model;
  readonly #node = h("p", { class: "soft small" });
  readonly #request = h("div", { class: "browse-body" });
  readonly #button = h("button", { type: "submit", class: "primary", disabled: true }, "Call");
  readonly #said = h("span", { class: "soft small", role: "status" });
  readonly #failure = h("p", { class: "error", role: "alert", hidden: true });
  readonly #response = h("div", { class: "browse-body service-response" });
  #form: MessageForm | undefined;
  #responseTypes: Types | undefined;
  #told: string | undefined;

  constructor(hub: Hub, model: Model, name: string, type: string) {
    this.#hub = hub;
    this.#model = model;
    this.name = name;
    this.type = type;
    this.element = h(
      "article",
      { class: "browse-page", "aria-label": name },
      h(
        "header",
        {},
        h("h2", { class: "mono" }, name),
        h(
          "a",
          {
            class: "button close",
            href: route("services"),
            "aria-label": "Close, back to all services",
          },
          "×",
        ),
      ),
      h("code", { class: "soft" }, type),
      this.#node,
      h(
        "form",
        {
          class: "browse-body",
          novalidate: true,
          "aria-label": `Call ${name}`,
          onsubmit: (event: Event) => {
            event.preventDefault();
            void this.#call();
          },
        },
        this.#request,
        h("div", { class: "toolbar" }, this.#button, this.#said),
      ),
      this.#failure,
      this.#response,
    );
    if (type !== "") void this.#make();
  }

  /** Who provides it: `undefined` if nobody does. */
  tell(node: string | undefined, known: boolean): void {
    if (this.#told === `${node} ${known}`) return;
    this.#told = `${node} ${known}`;
    if (node !== undefined)
      replace(
        this.#node,
        "provided by ",
        h("a", { class: "mono", href: route("graph", "node", node) }, node),
      );
    else say(this.#node, known ? "Nobody provides this service now." : "Waiting for the hub …");
  }

  async #make(): Promise<void> {
    try {
      const [request, response] = await Promise.all([
        this.#model.requestTypedefs(this.type),
        this.#model.responseTypedefs(this.type),
      ]);
      this.#form = new MessageForm(new Types(request));
      this.#responseTypes = new Types(response);
      replace(this.#request, this.#form.element);
      this.#button.disabled = false;
    } catch (error) {
      this.#fail((error as Error).message);
    }
  }

  async #call(): Promise<void> {
    const request = this.#form?.read();
    if (request === undefined || this.#button.disabled) return;
    this.#button.disabled = true;
    this.#failure.hidden = true;
    replace(this.#response);
    say(this.#said, "Waiting for the answer …");
    const start = performance.now();
    try {
      const response = await this.#hub.call<Message>(this.name, this.type, request);
      say(this.#said, `answered after ${(performance.now() - start).toFixed(1)} ms`);
      this.#show(response);
    } catch (error) {
      say(this.#said, `failed after ${(performance.now() - start).toFixed(1)} ms`);
      this.#fail((error as Error).message);
    } finally {
      this.#button.disabled = false;
    }
  }

  #fail(why: string): void {
    say(this.#failure, why);
    this.#failure.hidden = false;
  }

  #show(response: Message): void {
    const tree = new Tree(this.#responseTypes, this.#responseTypes?.root ?? "");
    tree.show(response);
    const copy = copyButton("Copy as JSON", () => JSON.stringify(response, null, 2));
    replace(
      this.#response,
      h("div", { class: "toolbar" }, h("h3", {}, "Response"), copy),
      tree.element,
    );
  }
}
