/** Drives a robot by a stick, the keyboard or a gamepad: publishes Twist while something is held. */
import "./teleop.css";

import { h, setText } from "../../dom";
import type { Message, Publication } from "../../hub";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import { type Config, numberIn, type Panel } from "../panel";
import {
  type Direction,
  Drive,
  directionOf,
  directionOfGamepad,
  directionOfStick,
  type Limits,
  type Velocity,
} from "./drive";

/** Seconds without a message after which the hub stops the robot: the page or its network is dead. */
const LEASE = 0.4;
const LIMITS: Limits = { speed: 0.5, turn: 1, ramp: 0.5 };
/** The greatest limits that one can set. */
const MOST: Limits = { speed: 20, turn: 20, ramp: 10 };
const STAMPED = "geometry_msgs/TwistStamped";
const STORED = "fibws.teleop";

export function makePanel(
  hub: DataSource,
  model: Model,
  topic: string,
  type: string,
  config?: Config,
): Panel {
  return new TeleopPanel(hub, model, topic, type, config);
}

/** A stick, with its knob and the pointer that holds it. */
interface Stick {
  readonly element: HTMLElement;
  readonly knob: HTMLElement;
  pointer: number | undefined;
}

class TeleopPanel implements Panel {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #topic: string;
  readonly #type: string;
  readonly #drive: Drive;
  readonly #stick = this.#newStick("stick");
  /** Turns, beside the other one that moves: on the screen of a phone, or if the user wants two. */
  readonly #turnStick = this.#newStick("turn");
  readonly #stop = h(
    "button",
    { type: "button", class: "teleop-stop", onclick: () => this.#toggleStop() },
    "STOP",
  );
  readonly #sideways = h("input", { type: "checkbox" });
  readonly #two = h("input", { type: "checkbox", onchange: () => this.#showSticks() });
  readonly #inputs: Record<keyof Limits, HTMLInputElement>;
  readonly #status = h("p", { class: "teleop-status", role: "status" }, "stopped");
  readonly #velocity = h("p", { class: "soft small mono" });
  readonly #others = h("p", { class: "soft small" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  #publication: Publication | undefined;
  #dropped = false;
  /** The next look at the gamepads. */
  #gamepad: number | undefined;
  #stops: (() => void)[] = [];

  constructor(hub: DataSource, model: Model, topic: string, type: string, config?: Config) {
    this.#hub = hub;
    this.#model = model;
    this.#topic = topic;
    this.#type = type;
    const limits = { ...storedLimits(topic), ...limitsIn(config) };
    this.#sideways.checked = config?.sideways === true;
    this.#two.checked = config?.two_sticks === true;
    this.#drive = new Drive(limits, {
      begin: () => this.#begin(),
      send: (velocity) => this.#send(velocity),
      end: () => this.#end(),
    });
    const limit = (name: keyof Limits, label: string) =>
      h("input", {
        type: "number",
        min: name === "ramp" ? 0 : 0.01,
        max: MOST[name],
        step: "any",
        value: String(limits[name]),
        "aria-label": label,
        onchange: () => this.#readLimits(),
      });
    this.#inputs = {
      speed: limit("speed", "Greatest speed in m/s"),
      turn: limit("turn", "Greatest turn in rad/s"),
      ramp: limit("ramp", "Seconds to the greatest speed"),
    };
    const { speed, turn, ramp } = this.#inputs;
    this.element = h(
      "div",
      {
        class: "teleop",
        tabindex: 0,
        role: "application",
        "aria-label": `Drive by ${topic}: arrow keys or W, A, S, D move, Q and E go sideways, space stops`,
        onkeydown: (event: KeyboardEvent) => this.#press(event),
        onkeyup: (event: KeyboardEvent) => this.#drive.release(event.code),
        onblur: () => this.#releaseAll(),
      },
      this.#error,
      h(
        "div",
        { class: "teleop-controls" },
        this.#stick.element,
        h("div", { class: "teleop-side" }, this.#stop, this.#status, this.#velocity, this.#others),
        this.#turnStick.element,
      ),
      h(
        "div",
        { class: "toolbar teleop-limits" },
        h("label", {}, "≤", speed, "m/s"),
        h("label", {}, "≤", turn, "rad/s"),
        h("label", {}, "ramp", ramp, "s"),
        h("label", {}, this.#sideways, "Sideways"),
        h("label", {}, this.#two, "Two sticks"),
      ),
      h(
        "p",
        { class: "soft small teleop-hint" },
        "The stick, or arrow keys and WASD once this has the focus, or a gamepad while one of its shoulder buttons is held.",
      ),
    );
    this.#showSticks();
  }

  config(): Config {
    return {
      ...this.#drive.limits,
      sideways: this.#sideways.checked,
      two_sticks: this.#two.checked,
    };
  }

  show(): void {
    if (this.#stops.length > 0) return;
    const release = (): void => this.#releaseAll();
    const events: [EventTarget, string][] = [
      [window, "blur"],
      [window, "pagehide"],
      [document, "visibilitychange"],
    ];
    for (const [target, event] of events) target.addEventListener(event, release);
    const poll = (): void => this.#pollGamepads();
    window.addEventListener("gamepadconnected", poll);
    this.#stops = [
      // What was held before a connection was lost must not move the robot after it.
      this.#hub.state.watch((state) => state !== "open" && release()),
      this.#model.graph.watch(() => this.#showOthers()),
      () => {
        for (const [target, event] of events) target.removeEventListener(event, release);
        window.removeEventListener("gamepadconnected", poll);
        if (this.#gamepad !== undefined) cancelAnimationFrame(this.#gamepad);
        this.#gamepad = undefined;
      },
    ];
    if (navigator.getGamepads().some((pad) => pad !== null)) poll();
  }

  hide(): void {
    this.#releaseAll();
    for (const stop of this.#stops) stop();
    this.#stops = [];
    this.#publication?.close();
    this.#publication = undefined;
  }

  // What is sent.

  #begin(): void {
    this.#showError("");
    this.#publication ??= this.#hub.advertise(this.#topic, this.#type, (why) => {
      this.#drive.releaseAll();
      this.#showError(why);
    });
    this.#publication.setWill(this.#message({ forward: 0, left: 0, turn: 0 }), LEASE);
    setText(this.#status, `driving ${this.#topic}`);
    this.element.classList.add("driving");
  }

  #send(velocity: Velocity): void {
    const isZero = velocity.forward === 0 && velocity.left === 0 && velocity.turn === 0;
    // Commands that wait would be executed late; a zero must arrive.
    this.#dropped = this.#hub.isCongested && !isZero;
    if (!this.#dropped) this.#publication?.publish(this.#message(velocity));
    const { forward, left, turn } = velocity;
    const sideways = left === 0 ? "" : `, ${left.toFixed(2)} m/s to the left`;
    const slow = this.#dropped ? " · the link is slow" : "";
    setText(
      this.#velocity,
      `${forward.toFixed(2)} m/s${sideways}, ${turn.toFixed(2)} rad/s${slow}`,
    );
  }

  #end(): void {
    this.#publication?.clearWill();
    setText(this.#status, this.#drive.isStopped ? "stopped until you resume" : "stopped");
    this.element.classList.remove("driving");
    for (const stick of [this.#stick, this.#turnStick]) center(stick, 0, 0);
  }

  #message({ forward, left, turn }: Velocity): Message {
    const twist = { linear: { x: forward, y: left, z: 0 }, angular: { x: 0, y: 0, z: turn } };
    // The hub stamps a header that is left out.
    return this.#type === STAMPED ? { twist } : twist;
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = why === "";
  }

  #showOthers(): void {
    const topic = this.#model.graph.value?.topics.find(({ name }) => name === this.#topic);
    // Echo below is no robot.
    const isOther = (node: string): boolean => !this.#hub.isOwn(node);
    const others = (topic?.publishers ?? []).map(({ node }) => node).filter(isOther);
    const listeners = (topic?.subscriptions ?? []).filter(({ node }) => isOther(node)).length;
    setText(
      this.#others,
      [
        others.length === 0 ? "" : `also published by ${others.join(", ")}`,
        listeners === 0 ? `no node subscribes to ${this.#topic}` : "",
      ]
        .filter((text) => text !== "")
        .join(" · "),
    );
  }

  // The sticks.

  #newStick(kind: "stick" | "turn"): Stick {
    const knob = h("div", { class: "teleop-knob" });
    const drop = (): void => {
      center(stick, 0, 0);
      this.#drive.release(kind);
    };
    const move = (event: PointerEvent): void => {
      if (!stick.element.hasPointerCapture(event.pointerId)) return;
      const box = stick.element.getBoundingClientRect();
      const radius = box.width / 2;
      const x = (event.clientX - box.left) / radius - 1;
      const y = (event.clientY - box.top) / radius - 1;
      this.#hold(kind, this.#directionOf(kind, x, y));
      const size = Math.max(1, Math.hypot(x, y));
      center(stick, x / size, y / size);
    };
    const grab = (event: PointerEvent): void => {
      if (event.button !== 0) return;
      // Before the capture: the panel may have the focus already, or a field in it.
      this.element.focus({ preventScroll: true });
      stick.element.setPointerCapture(event.pointerId);
      stick.pointer = event.pointerId;
      move(event);
      event.preventDefault();
    };
    const element = h(
      "div",
      {
        class: kind === "turn" ? "teleop-stick teleop-turn" : "teleop-stick",
        onpointerdown: grab,
        onpointermove: move,
        onpointerup: drop,
        onpointercancel: drop,
        onlostpointercapture: drop,
      },
      knob,
    );
    const stick: Stick = { element, knob, pointer: undefined };
    return stick;
  }

  /** The direction of a stick: with two of them, one moves and the other one turns. */
  #directionOf(kind: "stick" | "turn", x: number, y: number): Direction {
    if (kind === "turn") return { ...directionOfStick(x, y, false), forward: 0 };
    const direction = directionOfStick(x, y, this.#sideways.checked);
    return this.#turnStick.element.checkVisibility() ? { ...direction, turn: 0 } : direction;
  }

  #showSticks(): void {
    this.#releaseAll();
    this.element.classList.toggle("two", this.#two.checked);
  }

  /** Release everything; a finger that is still on a stick must be put on it again. */
  #releaseAll(): void {
    for (const stick of [this.#stick, this.#turnStick]) {
      const { element, pointer } = stick;
      if (pointer !== undefined && element.hasPointerCapture(pointer)) {
        element.releasePointerCapture(pointer);
      }
      stick.pointer = undefined;
    }
    this.#drive.releaseAll();
  }

  #hold(kind: string, direction: Direction): void {
    if (this.#hub.state.value !== "open") {
      this.#showError("Not connected to the hub: nothing is sent.");
      return;
    }
    this.#drive.hold(kind, direction);
  }

  // The keyboard, the stop and the gamepads.

  #press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    // A number in a field, or a button, has its own keys.
    if (event.target !== this.element) return;
    const direction = directionOf(event.code);
    if (event.code === "Space") {
      if (!event.repeat) this.#toggleStop();
    } else if (direction === undefined) {
      return;
    } else if (!event.repeat) {
      this.#hold(event.code, direction);
    }
    event.preventDefault();
  }

  #toggleStop(): void {
    if (this.#drive.isStopped) {
      this.#drive.resume();
      setText(this.#status, "stopped");
    } else {
      this.#drive.stop();
    }
    const { isStopped } = this.#drive;
    this.#stop.classList.toggle("on", isStopped);
    setText(this.#stop, isStopped ? "Resume" : "STOP");
  }

  /** Follow the gamepads, at the screen's rate, while there are any. */
  #pollGamepads(): void {
    if (this.#gamepad !== undefined) cancelAnimationFrame(this.#gamepad);
    const pads = navigator.getGamepads().filter((pad) => pad !== null);
    const directions = pads.flatMap((pad) => directionOfGamepad(pad) ?? []);
    const [direction] = directions;
    const isWatched = !document.hidden && document.hasFocus();
    if (direction === undefined || !isWatched) this.#drive.release("gamepad");
    else this.#hold("gamepad", direction);
    this.#gamepad =
      pads.length === 0 ? undefined : requestAnimationFrame(() => this.#pollGamepads());
  }

  #readLimits(): void {
    const limits = { ...this.#drive.limits };
    for (const [name, input] of Object.entries(this.#inputs)) {
      const isValid = input.checkValidity() && input.value !== "";
      input.toggleAttribute("aria-invalid", !isValid);
      if (isValid) limits[name as keyof Limits] = input.valueAsNumber;
    }
    this.#drive.limits = limits;
    try {
      localStorage.setItem(`${STORED}${this.#topic}`, JSON.stringify(limits));
    } catch {
      // The browser keeps nothing: they hold until the page is closed.
    }
  }
}

/** Move the knob of a stick from its middle, by parts of its radius. */
function center({ knob }: Stick, x: number, y: number): void {
  knob.style.translate = `${x * 100}% ${y * 100}%`;
}

/** The limits in a layout. */
function limitsIn(config: Config | undefined): Partial<Limits> {
  const limits: Record<string, number> = {};
  for (const [name, most] of Object.entries(MOST)) {
    const limit = numberIn(config, name, name === "ramp" ? 0 : 0.01, most);
    if (limit !== undefined) limits[name] = limit;
  }
  return limits;
}

/** The limits that somebody has set for a topic in this browser. */
function storedLimits(topic: string): Limits {
  let stored: unknown;
  try {
    stored = JSON.parse(localStorage.getItem(`${STORED}${topic}`) ?? "null");
  } catch {
    return LIMITS;
  }
  const limits: Record<string, number> = { ...LIMITS };
  for (const [name, value] of Object.entries(stored ?? {})) {
    if (name in LIMITS && typeof value === "number" && value >= 0) limits[name] = value;
  }
  return limits as unknown as Limits;
}
