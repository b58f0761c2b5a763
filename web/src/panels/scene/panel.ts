/** The panel of the scene: the picture, the list of its layers, and its tools. */
import "./scene.css";

import { h } from "../../dom";
import type { Hub } from "../../hub";
import type { Model } from "../../model";
import type { Panel } from "../panel";
import { Scene } from "./scene";

export function makePanel(hub: Hub, model: Model, topic: string): Panel {
  return new ScenePanel(hub, model, topic);
}

class ScenePanel implements Panel {
  readonly element: HTMLElement;
  readonly #scene: Scene;
  readonly #topic: string;
  #stops: (() => void)[] = [];

  constructor(hub: Hub, model: Model, topic: string) {
    this.#scene = new Scene(hub, model);
    this.#topic = topic;
    this.element = h(
      "div",
      { class: "scene" },
      h("div", { class: "scene-stage" }, this.#scene.canvas, this.#scene.labels),
    );
  }

  show(): void {
    if (this.#stops.length > 0) return;
    this.#scene.show();
    this.#stops = [
      this.#scene.model.graph.watch((graph) => {
        if (graph === null || !this.#scene.offer(graph)) return;
        for (const entry of this.#scene.entries) {
          if (entry.topic === this.#topic || entry.kind.isFirst) this.#scene.toggle(entry, true);
        }
      }),
    ];
  }

  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
    this.#scene.hide();
  }
}
