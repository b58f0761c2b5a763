/** Shows a camera, or a map: the newest image of a topic, its age and rate, and the value under the pointer. */
import "./image.css";

import { h, setAttribute, setText } from "../../dom";
import { download } from "../../download";
import { ago, bytes, hertz } from "../../format";
import { type Send, subscribe } from "../../messages/data_client";
import type { Model, Time } from "../../model";
import { SimulatedTime } from "../../simulated_time";
import type { DataSource } from "../../source";
import { type Config, numberIn, type Panel } from "../panel";
import type { PictureState } from "./picture";
import type { Options } from "./pixels";
import type { Report, Request } from "./worker_messages";

/** Time between two updates of the line below the picture, in ms. */
const TICK = 250;
/** Time between two updates of what screen readers are told, in ms. */
const DESCRIBED = 5000;
/** An image is old after this time, in ms. */
const STALE = 2000;
/** A stamp that is further away is another clock's, in ms. */
const SAME_CLOCK = 3_600_000;
/** The least time between two messages of /clock, in ms: it is shown four times a second. */
const CLOCK_THROTTLE = 50;
/** The part of a new rate in the shown one. */
const SMOOTHING = 0.3;
/** Steps of zoom by the buttons and the wheel. */
const ZOOM = 1.25;
const MIN_ZOOM = 0.05;
const MAX_ZOOM = 32;
/** From here on, pixels are squares. */
const SQUARES = 2;

/** The least time between two images, in ms, with some play for cameras of exactly that rate. */
const RATES: readonly (readonly [hertz: number, throttle: number])[] = [
  [30, 25],
  [15, 60],
  [5, 190],
  [1, 980],
];

/** The first rate of each type, as an index of `RATES`. */
const FIRST_RATES: Readonly<Record<string, number>> = {
  "sensor_msgs/Image": 1,
  "nav_msgs/OccupancyGrid": 2,
};

export function makePanel(
  hub: DataSource,
  model: Model,
  topic: string,
  type: string,
  config?: Config,
): Panel {
  return new ImagePanel(hub, model, topic, type, config);
}

class ImagePanel implements Panel {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #topic: string;
  readonly #type: string;
  /** Whether images are expected again and again; a map may come only once. */
  readonly #isCamera: boolean;
  readonly #stage = h("div", {
    class: "image-stage",
    tabindex: 0,
    role: "group",
    "aria-label": "Picture; arrow keys move the point whose value is shown, space pauses",
    onkeydown: (event: KeyboardEvent) => this.#press(event),
    onpointermove: (event: PointerEvent) => this.#point(event),
    onpointerleave: () => setText(this.#value, ""),
    onwheel: (event: WheelEvent) => this.#wheel(event),
  });
  readonly #pause = h(
    "button",
    { type: "button", title: "Space", onclick: () => this.#togglePause() },
    "Pause",
  );
  readonly #rate = h(
    "select",
    { "aria-label": "Most images per second", onchange: () => this.#subscribe() },
    ...RATES.map(([most], at) => h("option", { value: at }, `≤ ${most} Hz`)),
  );
  readonly #palette = h(
    "select",
    { "aria-label": "Colours of depths", hidden: true, onchange: () => this.#sendOptions() },
    h("option", { value: "grey" }, "Grey"),
    h("option", { value: "color" }, "Colours"),
  );
  readonly #fault = h("p", { class: "error", role: "alert", hidden: true });
  readonly #waiting = h("p", { class: "soft image-waiting" });
  readonly #facts = h("p", { class: "soft small image-facts" });
  readonly #value = h("p", { class: "small mono image-value", role: "status" });
  #canvas: HTMLCanvasElement | undefined;
  #send: Send<Request> | undefined;
  #state: PictureState | undefined;
  #paused = false;
  /** undefined: as large as fits. */
  #zoom: number | undefined;
  #hz = 0;
  #counted = { shown: 0, at: 0 };
  #describedAt = -Infinity;
  /** The point whose value is shown, in pixels of the image. */
  #cursor = { x: 0, y: 0 };
  #timer: number | undefined;
  #clock = new SimulatedTime();
  #unwatch: (() => void) | undefined;
  #stopClock: (() => void) | undefined;
  /** Whether it is visible. */
  #visible = false;

  constructor(hub: DataSource, model: Model, topic: string, type: string, config?: Config) {
    this.#hub = hub;
    this.#model = model;
    this.#topic = topic;
    this.#type = type;
    this.#isCamera = type !== "nav_msgs/OccupancyGrid";
    const rate = RATES.findIndex(([most]) => most === config?.max_hz);
    this.#rate.value = String(rate === -1 ? (FIRST_RATES[type] ?? 0) : rate);
    if (config?.palette === "color") this.#palette.value = "color";
    this.#zoom = numberIn(config, "zoom", MIN_ZOOM, MAX_ZOOM);
    const button = (label: string, title: string, onclick: () => void) =>
      h("button", { type: "button", title, "aria-label": title, onclick }, label);
    this.element = h(
      "div",
      { class: "image-panel" },
      h(
        "div",
        { class: "toolbar" },
        this.#pause,
        this.#rate,
        this.#palette,
        button("−", "Zoom out", () => this.#zoomBy(1 / ZOOM)),
        button("+", "Zoom in", () => this.#zoomBy(ZOOM)),
        h("button", { type: "button", onclick: () => this.#setZoom(undefined) }, "Fit"),
        h("button", { type: "button", onclick: () => this.#setZoom(1) }, "1:1"),
        h(
          "button",
          { type: "button", onclick: () => void this.#stage.requestFullscreen() },
          "Full screen",
        ),
        h("button", { type: "button", onclick: () => this.#send?.({ kind: "file" }) }, "Save"),
      ),
      this.#fault,
      this.#stage,
      this.#waiting,
      this.#facts,
      this.#value,
    );
  }

  show(): void {
    if (this.#visible) return;
    this.#visible = true;
    this.#unwatch = this.#hub.clock.onJump(() => this.#clear());
    this.#open();
    this.#timer = window.setInterval(() => this.#tick(), TICK);
    this.#tick();
  }

  /** Time has jumped: show nothing until there is an image of then. */
  #clear(): void {
    this.#state = undefined;
    if (this.#canvas !== undefined) this.#canvas.hidden = true;
    this.#tick();
  }

  hide(): void {
    this.#visible = false;
    this.#unwatch?.();
    window.clearInterval(this.#timer);
    this.#stopClock?.();
    this.#stopClock = undefined;
    this.#clock = new SimulatedTime();
    this.#send?.({ kind: "close" });
    this.#send = undefined;
    // The worker's canvas cannot come back: the next one is new.
    this.#canvas?.remove();
    this.#canvas = undefined;
    this.#state = undefined;
    this.#showFault("");
    setText(this.#facts, "");
    setText(this.#value, "");
  }

  config(): Config {
    return {
      max_hz: RATES[Number(this.#rate.value)]?.[0],
      palette: this.#palette.value,
      ...(this.#zoom === undefined ? {} : { zoom: this.#zoom }),
    };
  }

  #open(): void {
    const canvas = h("canvas", { role: "img", width: 1, height: 1, hidden: true });
    this.#canvas = canvas;
    this.#stage.append(canvas);
    const offscreen = canvas.transferControlToOffscreen();
    this.#counted = { shown: 0, at: performance.now() };
    this.#send = this.#hub.open<Request, Report>(
      {
        kind: "picture",
        canvas: offscreen,
        topic: this.#topic,
        type: this.#type,
        throttle: this.#throttle,
      },
      [offscreen],
      (report) => this.#receive(report),
    );
    if (this.#paused) this.#subscribe();
    this.#sendOptions();
    this.#setZoom(this.#zoom);
  }

  get #throttle(): number {
    return RATES[Number(this.#rate.value)]?.[1] ?? 0;
  }

  #subscribe(): void {
    this.#send?.({ kind: "throttle", throttle: this.#paused ? null : this.#throttle });
  }

  #sendOptions(): void {
    const options: Options = { palette: this.#palette.value as Options["palette"] };
    this.#send?.({ kind: "options", options });
  }

  #receive(report: Report): void {
    switch (report.kind) {
      case "state":
        this.#showState(report.state);
        break;
      case "fault":
        this.#showFault(report.why);
        break;
      case "value":
        setText(this.#value, `x ${report.x}, y ${report.y}: ${report.text}`);
        break;
      case "file":
        download(`${this.#topic.slice(1).replaceAll("/", "_")}.png`, report.file);
        break;
    }
  }

  #showState(state: PictureState): void {
    const before = this.#state;
    this.#showFault("");
    const { clock } = this.#hub;
    const drawn = clock.playback.value.isLive ? state.drawn : clock.now();
    this.#state = { ...state, drawn };
    if (this.#canvas !== undefined) this.#canvas.hidden = false;
    // How large its pixels are depends on its size.
    if (state.width !== before?.width || state.height !== before.height) this.#setZoom(this.#zoom);
    if (before === undefined) this.#tick();
  }

  #showFault(why: string): void {
    setText(this.#fault, why);
    this.#fault.hidden = why === "";
  }

  #togglePause(): void {
    this.#paused = !this.#paused;
    this.#pause.classList.toggle("on", this.#paused);
    setText(this.#pause, this.#paused ? "Resume" : "Pause");
    this.#subscribe();
    this.#tick();
  }

  /** Update the lines below the picture. */
  #tick(): void {
    const state = this.#state;
    setText(this.#waiting, state === undefined ? this.#whyEmpty() : "");
    if (state === undefined) {
      setText(this.#facts, "");
      return;
    }
    this.#measure(state.shown);
    this.#palette.hidden = state.limits === undefined;
    const age = this.#hub.clock.now() - state.drawn;
    this.#stage.classList.toggle("stale", this.#isCamera && !this.#paused && age > STALE);
    const size = `${state.width} × ${state.height}`;
    const parts = [
      this.#paused ? "paused" : hertz(this.#hz),
      `${size} ${state.encoding}`,
      bytes(state.bytes),
      this.#age(state),
    ];
    if (state.limits !== undefined) {
      const [low, high] = state.limits.map((each) => Number(each.toPrecision(4)));
      parts.push(`shown from ${low} to ${high}`);
    }
    setText(this.#facts, parts.join(" · "));
    if (performance.now() - this.#describedAt > DESCRIBED && this.#canvas !== undefined) {
      this.#describedAt = performance.now();
      setAttribute(
        this.#canvas,
        "aria-label",
        `${this.#isCamera ? "Camera" : "Map"} ${this.#topic}: ${parts.join(", ")}`,
      );
    }
  }

  #measure(shown: number): void {
    const now = performance.now();
    const seconds = (now - this.#counted.at) / 1000;
    if (seconds < 0.9) return;
    const hz = (shown - this.#counted.shown) / seconds;
    this.#hz = this.#hz === 0 || hz === 0 ? hz : this.#hz + SMOOTHING * (hz - this.#hz);
    this.#counted = { shown, at: now };
  }

  #age({ stamp, drawn }: PictureState): string {
    const since = this.#hub.clock.now() - drawn;
    if (!this.#isCamera) return ago(since / 1000);
    if (since > STALE) return `${Math.floor(since / 1000)} s without an image`;
    if (stamp === 0) return "no time stamp";
    let age = drawn - stamp;
    if (Math.abs(age) > SAME_CLOCK) {
      this.#followClock();
      age = (this.#clock.now(drawn) ?? Infinity) - stamp;
      if (Math.abs(age) > SAME_CLOCK) return "stamped by another clock";
    }
    return `${Math.round(age)} ms old`;
  }

  /** Take the time of /clock, if a node publishes it. */
  #followClock(): void {
    const clock = this.#model.graph.value?.topics.find(({ name }) => name === "/clock");
    if (this.#stopClock !== undefined || !clock?.publishers.length) return;
    const wanted = { topic: "/clock", throttle: CLOCK_THROTTLE };
    this.#stopClock = subscribe(this.#hub, wanted, ({ clock }, { time }) => {
      const { secs, nsecs } = clock as Time;
      this.#clock.receive(secs * 1000 + nsecs / 1e6, time);
    });
  }

  #whyEmpty(): string {
    const topic = this.#model.graph.value?.topics.find(({ name }) => name === this.#topic);
    if (topic === undefined || topic.publishers.length === 0) {
      return `No image: no node publishes ${this.#topic}.`;
    }
    return this.#paused ? "Paused." : "Waiting for the first image …";
  }

  // Zoom, and the value under the pointer.

  #setZoom(zoom: number | undefined): void {
    this.#zoom = zoom;
    const canvas = this.#canvas;
    if (canvas === undefined) return;
    canvas.classList.toggle("fits", zoom === undefined);
    canvas.classList.toggle("squares", this.#scale() >= SQUARES);
    canvas.style.width = zoom === undefined ? "" : `${(this.#state?.width ?? 0) * zoom}px`;
  }

  #zoomBy(factor: number): void {
    this.#setZoom(Math.min(MAX_ZOOM, Math.max(MIN_ZOOM, this.#scale() * factor)));
  }

  #wheel(event: WheelEvent): void {
    // Without Ctrl the wheel scrolls the page; a pinch on a touchpad arrives with it.
    if (!event.ctrlKey || this.#state === undefined) return;
    event.preventDefault();
    const before = this.#place(event);
    this.#zoomBy(event.deltaY < 0 ? ZOOM : 1 / ZOOM);
    const after = this.#place(event);
    const scale = this.#scale();
    this.#stage.scrollLeft += (before.x - after.x) * scale;
    this.#stage.scrollTop += (before.y - after.y) * scale;
  }

  /** Pixels of the screen for one of the image. */
  #scale(): number {
    const { width = 1, height = 1 } = this.#state ?? {};
    if (this.#zoom !== undefined) return this.#zoom;
    const box = this.#canvas?.getBoundingClientRect();
    return box === undefined ? 1 : Math.min(box.width / width, box.height / height);
  }

  /** The place of the pointer in the image, in its pixels. */
  #place({ clientX, clientY }: { clientX: number; clientY: number }): { x: number; y: number } {
    const box = this.#canvas?.getBoundingClientRect() ?? new DOMRect();
    const { width = 1, height = 1 } = this.#state ?? {};
    const scale = this.#scale();
    // A picture that fits may have bars at two of its sides.
    return {
      x: (clientX - box.left - (box.width - width * scale) / 2) / scale,
      y: (clientY - box.top - (box.height - height * scale) / 2) / scale,
    };
  }

  #point(event: PointerEvent): void {
    const { x, y } = this.#place(event);
    this.#ask(Math.floor(x), Math.floor(y));
    if (event.buttons === 1 && this.#zoom !== undefined) {
      this.#stage.scrollLeft -= event.movementX;
      this.#stage.scrollTop -= event.movementY;
    }
  }

  #ask(x: number, y: number): void {
    const { width = 0, height = 0 } = this.#state ?? {};
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    this.#cursor = { x, y };
    this.#send?.({ kind: "value", x, y });
  }

  #press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const steps: Record<string, readonly [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    const step = steps[event.key];
    if (event.key === " ") {
      if (!event.repeat) this.#togglePause();
    } else if (step !== undefined) {
      this.#ask(this.#cursor.x + step[0], this.#cursor.y + step[1]);
    } else {
      return;
    }
    event.preventDefault();
  }
}
