/** The page of one service: a form for the request, and the response as a tree. */
import { browsePage } from "../browse";
import { copyButton } from "../copy_button";
import { h, replace, setText } from "../dom";
import { MessageForm } from "../form/message_form";
import type { Message } from "../hub";
import { MessageTree } from "../message_tree";
import type { Model } from "../model";
import type { DataSource } from "../source";
import { Types } from "../types";
import { route } from "../view";

export class ServicePage {
  readonly element: HTMLElement;
  readonly name: string;
  readonly type: string;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #node = h("p", { class: "soft small" });
  readonly #request = h("div", { class: "browse-body" });
  readonly #button = h("button", { type: "submit", class: "primary", disabled: true }, "Call");
  readonly #status = h("span", { class: "soft small", role: "status" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #response = h("div", { class: "browse-body service-response" });
  #form: MessageForm | undefined;
  #responseTypes: Types | undefined;
  #shownNode: string | undefined;

  constructor(hub: DataSource, model: Model, name: string, type: string) {
    this.#hub = hub;
    this.#model = model;
    this.name = name;
    this.type = type;
    this.element = browsePage(
      name,
      "services",
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
        h("div", { class: "toolbar" }, this.#button, this.#status),
      ),
      this.#error,
      this.#response,
    );
    if (type !== "") void this.#loadTypes();
  }

  /** Show the node that provides the service, if there is one. */
  showNode(node: string | undefined, known: boolean): void {
    if (this.#shownNode === `${node} ${known}`) return;
    this.#shownNode = `${node} ${known}`;
    if (node !== undefined)
      replace(
        this.#node,
        "provided by ",
        h("a", { class: "mono", href: route("graph", "node", node) }, node),
      );
    else
      setText(this.#node, known ? "No node provides this service now." : "Waiting for the hub …");
  }

  async #loadTypes(): Promise<void> {
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
      this.#showError((error as Error).message);
    }
  }

  async #call(): Promise<void> {
    const request = this.#form?.read();
    if (request === undefined || this.#button.disabled) return;
    this.#button.disabled = true;
    this.#error.hidden = true;
    replace(this.#response);
    setText(this.#status, "Waiting for the response …");
    const start = performance.now();
    try {
      const response = await this.#hub.call<Message>(this.name, this.type, request);
      setText(this.#status, `response after ${(performance.now() - start).toFixed(1)} ms`);
      this.#showResponse(response);
    } catch (error) {
      setText(this.#status, `failed after ${(performance.now() - start).toFixed(1)} ms`);
      this.#showError((error as Error).message);
    } finally {
      this.#button.disabled = false;
    }
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = false;
  }

  #showResponse(response: Message): void {
    const tree = new MessageTree(this.#responseTypes, this.#responseTypes?.root ?? "");
    tree.show(response);
    const copy = copyButton("Copy as JSON", () => JSON.stringify(response, null, 2));
    replace(
      this.#response,
      h("div", { class: "toolbar" }, h("h3", {}, "Response"), copy),
      tree.element,
    );
  }
}
