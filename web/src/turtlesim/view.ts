/** The Turtlesim tab: the turtles of a simulator, what they draw, and keys to drive one. */
import "./turtlesim.css";

import { h, replace, setText, svg } from "../dom";
import type { Message, Publication } from "../hub";
import { subscribe } from "../messages/data_client";
import { bytes } from "../messages/values";
import type { Model } from "../model";
import type { Panel } from "../panels/panel";
import type { DataSource } from "../source";
import { type MakeView, route, type View } from "../view";
import {
  PIXELS,
  type PoseMessage,
  type SimulatedTurtle,
  type Simulator,
  SPAWN,
  simulatorsOf,
  textOf,
  transformOf,
} from "./simulators";

/** Time between two poses of a turtle, in ms. */
const INTERVAL = 30;
/** Meters and radians per second. */
const SPEED = 2;
const TURN = 2;
/** What each key means: forwards, and to the left. */
const KEYS: Record<string, readonly [number, number]> = {
  ArrowUp: [SPEED, 0],
  ArrowDown: [-SPEED, 0],
  ArrowLeft: [0, TURN],
  ArrowRight: [0, -TURN],
};
const TWIST = "geometry_msgs/Twist";
/** The colours of turtles, as classes of the style sheet. */
const COLORS = 6;

export const makeView: MakeView = (hub, model) => new TurtlesimView(hub, model);

class TurtlesimView implements View {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #simulators = h("nav", { class: "toolbar", "aria-label": "Simulators", hidden: true });
  readonly #driven = h("select", {
    "aria-label": "Turtle that the arrow keys drive",
    onchange: () => void this.#toggleStick(),
  });
  readonly #canvas = h("canvas", { width: PIXELS, height: PIXELS, "aria-hidden": "true" });
  readonly #turtles = svg("svg", { viewBox: `0 0 ${PIXELS} ${PIXELS}`, "aria-hidden": "true" });
  readonly #stage: HTMLElement;
  readonly #list = h("ul", { class: "turtles", "aria-label": "Turtles" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #content: HTMLElement;
  readonly #empty = h(
    "p",
    { class: "empty" },
    "No turtlesim is running. To start one: ",
    h("code", {}, "fibws run turtlesim turtlesim_node"),
  );
  /** For phones, which have no keys. */
  readonly #stick = h(
    "details",
    { class: "turtle-stick", ontoggle: () => void this.#toggleStick() },
    h("summary", {}, "Stick"),
  );
  #panel: Panel | undefined;
  #node = "";
  #simulator: Simulator | undefined;
  #shown = "";
  #stops: (() => void)[] = [];
  #commands: { base: string; publication: Publication } | undefined;
  /** The newest picture that has not been drawn, while one is being decoded. */
  #next: Message | undefined;
  #isDecoding = false;
  #stop: (() => void) | undefined;

  constructor(hub: DataSource, model: Model) {
    this.#hub = hub;
    this.#model = model;
    this.#stage = h(
      "div",
      {
        class: "turtle-field",
        tabindex: 0,
        role: "application",
        "aria-label": "Field of the turtles: arrow keys drive one",
        onkeydown: (event: KeyboardEvent) => this.#press(event),
        onkeyup: (event: KeyboardEvent) => event.key in KEYS && this.#drive(0, 0),
        onblur: () => this.#drive(0, 0),
      },
      this.#canvas,
      this.#turtles,
    );
    const button = (label: string, service: string, type: string) =>
      h("button", { type: "button", onclick: () => void this.#call(service, type) }, label);
    this.#content = h(
      "div",
      { class: "turtlesim-content", hidden: true },
      this.#simulators,
      h(
        "div",
        { class: "toolbar" },
        h("label", {}, "Arrow keys drive", this.#driven),
        button("Clear", "clear", "std_srvs/Empty"),
        button("Reset", "reset", "std_srvs/Empty"),
        button("Spawn a turtle", "spawn", SPAWN),
      ),
      this.#error,
      this.#stage,
      h("div", { class: "turtle-side" }, this.#stick, this.#list),
    );
    this.element = h(
      "section",
      { class: "turtlesim", "aria-label": "Turtlesim" },
      this.#empty,
      this.#content,
    );
  }

  show([node = ""]: string[]): void {
    this.#node = node;
    this.#stop ??= this.#model.graph.watch(() => this.#update());
    this.#update();
    this.#stage.focus({ preventScroll: true });
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    this.#close();
  }

  #update(): void {
    const graph = this.#model.graph.value;
    const all = graph === null ? [] : simulatorsOf(graph);
    const simulator = all.find(({ node }) => node === this.#node) ?? all[0];
    this.#empty.hidden = simulator !== undefined || graph === null;
    this.#content.hidden = simulator === undefined;
    const shown = JSON.stringify([simulator, all.map(({ node }) => node)]);
    if (shown === this.#shown) return;
    this.#close();
    this.#shown = shown;
    this.#simulator = simulator;
    this.#simulators.hidden = all.length < 2;
    replace(this.#simulators, ...all.map(({ node }) => chip(node, node === simulator?.node)));
    if (simulator !== undefined) this.#open(simulator);
  }

  #open({ turtles, picture }: Simulator): void {
    const driven = this.#driven.value;
    replace(this.#driven, ...turtles.map(({ name, base }) => h("option", { value: base }, name)));
    if (turtles.some(({ base }) => base === driven)) this.#driven.value = driven;
    replace(this.#turtles);
    replace(this.#list);
    for (const [index, turtle] of turtles.entries()) this.#follow(turtle, index);
    void this.#toggleStick();
    this.#canvas.getContext("2d")?.clearRect(0, 0, PIXELS, PIXELS);
    if (picture === "") return;
    this.#stops.push(
      subscribe(this.#hub, { topic: picture }, (message) => void this.#draw(message)),
    );
  }

  /** Show a stick for the chosen turtle, or end it. */
  async #toggleStick(): Promise<void> {
    const { makePanel } = await import("../panels/teleop/panel");
    this.#closePanel();
    const base = this.#driven.value;
    if (!this.#stick.open || base === "" || this.#stop === undefined) return;
    this.#panel = makePanel(this.#hub, this.#model, `${base}/cmd_vel`, TWIST);
    this.#stick.append(this.#panel.element);
    this.#panel.show();
  }

  #closePanel(): void {
    this.#panel?.hide();
    this.#panel?.element.remove();
    this.#panel = undefined;
  }

  #close(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
    this.#commands?.publication.close();
    this.#commands = undefined;
    this.#closePanel();
    this.#shown = "";
  }

  /** Show where a turtle is. */
  #follow({ name, base }: SimulatedTurtle, index: number): void {
    const shape = turtleShape(index % COLORS);
    const text = h("span", { class: "mono" });
    this.#turtles.append(shape);
    this.#list.append(h("li", {}, h("b", {}, name), " ", text));
    const wanted = { topic: `${base}/pose`, throttle: INTERVAL };
    const stop = subscribe(this.#hub, wanted, (message) => {
      const pose = message as unknown as PoseMessage;
      shape.setAttribute("transform", transformOf(pose));
      setText(text, textOf(pose));
    });
    this.#stops.push(stop);
  }

  /** Draw a picture, the newest one if several come meanwhile. */
  async #draw(message: Message): Promise<void> {
    this.#next = message;
    if (this.#isDecoding) return;
    this.#isDecoding = true;
    while (this.#next !== undefined) {
      const png = bytes(this.#next.data) as Uint8Array<ArrayBuffer>;
      this.#next = undefined;
      try {
        const bitmap = await createImageBitmap(new Blob([png], { type: "image/png" }));
        this.#canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
        bitmap.close();
      } catch (error) {
        this.#showError(`The picture is invalid: ${(error as Error).message}`);
      }
    }
    this.#isDecoding = false;
  }

  #press(event: KeyboardEvent): void {
    const command = KEYS[event.key];
    if (command === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    this.#drive(...command);
  }

  #drive(forwards: number, left: number): void {
    const base = this.#driven.value;
    if (base === "" || (this.#commands === undefined && forwards === 0 && left === 0)) return;
    if (this.#commands?.base !== base) {
      this.#commands?.publication.close();
      const topic = `${base}/cmd_vel`;
      const publication = this.#hub.advertise(topic, TWIST, (why) => this.#showError(why));
      this.#commands = { base, publication };
    }
    this.#commands.publication.publish({ linear: { x: forwards }, angular: { z: left } });
  }

  async #call(service: string, type: string): Promise<void> {
    const request = type === SPAWN ? { x: 1 + 9 * Math.random(), y: 1 + 9 * Math.random() } : {};
    try {
      await this.#hub.call(`${this.#simulator?.prefix ?? "/"}${service}`, type, request);
      this.#error.hidden = true;
    } catch (error) {
      this.#showError((error as Error).message);
    }
    this.#stage.focus({ preventScroll: true });
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = false;
  }
}

function chip(node: string, isChosen: boolean): HTMLElement {
  const attributes = { class: "button", href: route("turtlesim", node) };
  return h("a", { ...attributes, "aria-current": isChosen ? "true" : null }, node);
}

/** A turtle from above that looks to the right, with its middle at (0, 0). */
function turtleShape(color: number): SVGElement {
  const legs = [
    [11, 13],
    [11, -13],
    [-11, 13],
    [-11, -13],
  ] as const;
  return svg(
    "g",
    { class: `turtle turtle-${color}` },
    ...legs.map(([cx, cy]) => svg("circle", { cx, cy, r: 5.5, class: "limb" })),
    svg("circle", { cx: 20, cy: 0, r: 6.5, class: "limb" }),
    svg("path", { d: "M-14 -3 L-23 0 L-14 3 Z", class: "limb" }),
    svg("circle", { cx: 22.5, cy: -2.5, r: 1.2, class: "eye" }),
    svg("circle", { cx: 22.5, cy: 2.5, r: 1.2, class: "eye" }),
    svg("ellipse", { rx: 17, ry: 14.5, class: "shell" }),
    svg("path", {
      d: "M-7 0 L-3.5 -6 L3.5 -6 L7 0 L3.5 6 L-3.5 6 Z M-7 0 H-16 M7 0 H16 M3.5 6 L7 12 M-3.5 6 L-7 12 M3.5 -6 L7 -12 M-3.5 -6 L-7 -12",
      class: "plates",
    }),
  );
}
