/** The panel of the scene: the picture, the list of its layers, and its tools. */
import { append } from "../../lists";
import "./scene.css";

import { h, replace, setAttribute, setText } from "../../dom";
import type { Graph, Model } from "../../model";
import type { DataSource } from "../../source";
import { rollPitchYaw } from "../../transforms";
import { own } from "../../types";
import { route } from "../../view";
import type { Panel } from "../panel";
import type { CameraState, Follow } from "./camera";
import { Gestures, type GestureTarget, moveByKey, type Press } from "./gestures";
import { LAYER_KINDS } from "./kinds";
import type { Pointer, View } from "./layer";
import { LayerList } from "./layer_list";
import { placeText } from "./picking";
import { renderer } from "./renderer";
import { Scene } from "./scene";
import { TOOLS, type ToolName, Tools } from "./tools";
import type { LayerId } from "./types";

/** Time between two updates of the states in words, in ms. */
const TICK = 250;
/** Time between two updates of what screen readers are told, in ms. */
const DESCRIBED = 5000;
/** A hidden tab ends its subscriptions after this time, in ms. */
const HIDDEN = 10_000;
/** Most layers that a scene of no topic shows by itself. */
const MAX_FIRST = 12;

/** What layouts of fibws 0.1 call the kinds of layers. */
const FORMER_IDS: Readonly<Record<string, LayerId>> = {
  "Camera's view": "camera",
  "Frames (tf)": "frames",
  "Grid cells": "gridCells",
  "Interactive markers": "interactiveMarkers",
  "Laser scan": "laserScan",
  "Point cloud": "pointCloud",
  "Robot model": "robot",
  "Twist or wrench": "arrows",
  Map: "map",
  Markers: "markers",
  Odometry: "odometry",
  Path: "path",
  Point: "point",
  Polygon: "polygon",
  Pose: "pose",
  Poses: "poses",
  Range: "range",
};

/** A scene as it is saved. */
interface Config {
  readonly layers: readonly SavedLayer[];
  readonly frame: string;
  readonly follow: Follow;
  readonly followFrame: string;
  readonly camera: CameraState;
  readonly topics: Readonly<Record<string, string>>;
  /** False if the list of layers is hidden where it has room. */
  readonly list: boolean;
}

interface SavedLayer {
  readonly topic: string;
  readonly type: string;
  readonly kind: string;
  readonly settings: Readonly<Record<string, unknown>>;
}

/** `topic` is empty for a scene that begins with what the graph has. */
export function makePanel(
  hub: DataSource,
  model: Model,
  topic: string,
  _type = "",
  config: Readonly<Record<string, unknown>> = {},
): Panel & { config(): Record<string, unknown> } {
  return new ScenePanel(hub, model, topic, config);
}

class ScenePanel implements Panel, GestureTarget {
  readonly element: HTMLElement;
  readonly #scene: Scene;
  readonly #model: Model;
  readonly #topic: string;
  readonly #list: LayerList;
  readonly #tools: Tools;
  /** Whether layers are chosen by what there is, until somebody chooses. */
  #isAuto: boolean;
  /** Whether the camera is placed by what there is, until somebody moves it. */
  #isPlaced: boolean;
  /** What the picture was last made to fit. */
  #fitted = "";
  readonly #stage: HTMLElement;
  readonly #layersButton = h(
    "button",
    {
      type: "button",
      class: "toggle",
      "aria-expanded": "false",
      onclick: () => this.#toggleList(),
    },
    "Layers",
  );
  readonly #modes: Readonly<Record<"orbit" | "top", HTMLButtonElement>>;
  readonly #follow = h(
    "select",
    { "aria-label": "Follow the robot", onchange: () => this.#setFollow() },
    h("option", { value: "off" }, "Follow: off"),
    h("option", { value: "position" }, "Follow: position"),
    h("option", { value: "heading" }, "Follow: heading"),
  );
  readonly #fixed = h("select", {
    "aria-label": "Fixed frame",
    onchange: () => {
      this.#scene.fixedChoice = this.#fixed.value;
      this.#scene.redraw();
    },
  });
  readonly #fault = h("p", { class: "error", role: "alert", hidden: true });
  readonly #hover = h("p", { class: "small mono scene-hover" });
  readonly #text = h("details", { class: "scene-text small" }, h("summary", {}, "As text"));
  readonly #lines = h("ul", {});
  #frames = "";
  #pointer: Pointer | undefined;
  #hoverFrame: number | undefined;
  #describedAt = Number.NEGATIVE_INFINITY;
  #timer: number | undefined;
  #hiddenTimer: number | undefined;
  #stops: (() => void)[] = [];

  constructor(
    hub: DataSource,
    model: Model,
    topic: string,
    config: Readonly<Record<string, unknown>>,
  ) {
    this.#model = model;
    this.#topic = topic;
    this.#scene = new Scene(hub, model);
    const change = (): void => {
      this.#isAuto = false;
    };
    this.#list = new LayerList(this.#scene, model, change);
    this.#tools = new Tools(this.#scene, hub, model, change);
    this.#scene.overlay = (view: View) => this.#tools.draw(view);
    this.#scene.onDrawn = () => this.#drawn();
    this.#isAuto = !Array.isArray(config.layers);
    this.#isPlaced = typeof config.camera === "object" && config.camera !== null;
    this.#restore(config);
    this.#modes = { orbit: this.#modeButton("orbit", "3D"), top: this.#modeButton("top", "2D") };
    this.#stage = h(
      "div",
      {
        class: "scene-stage",
        tabindex: 0,
        role: "group",
        "aria-label":
          "Scene; arrow keys turn, with Shift they move, plus and minus zoom, 0 shows all, 1, 2 and 3 choose a view",
        onkeydown: (event: KeyboardEvent) => this.#press(event),
      },
      this.#scene.canvas,
      this.#scene.labels,
      this.#tools.lens,
      this.#hover,
    );
    new Gestures(this.#stage, this);
    this.#text.append(this.#lines);
    this.#text.addEventListener("toggle", () => this.#describe());
    this.element = h(
      "div",
      { class: "scene", onkeydown: (event: KeyboardEvent) => this.#escape(event) },
      h(
        "div",
        { class: "toolbar scene-bar" },
        this.#layersButton,
        h("span", { class: "scene-modes" }, this.#modes.orbit, this.#modes.top),
        h("button", { type: "button", title: "Show all (0)", onclick: () => this.#fit() }, "Fit"),
        ...this.#tools.buttons,
        this.#follow,
        this.#fixed,
      ),
      this.#fault,
      h("div", { class: "scene-main" }, this.#list.element, this.#stage, this.#tools.bar),
      this.#tools.status,
      this.#text,
    );
    this.element.classList.toggle("without-list", config.list === false);
    this.#showModes();
  }

  show(): void {
    if (this.#stops.length > 0) return;
    // Whether the list is shown depends on the width, too.
    const sizes = new ResizeObserver(([list]) => {
      const isOpen = list !== undefined && list.contentRect.width > 0;
      setAttribute(this.#layersButton, "aria-expanded", String(isOpen));
    });
    sizes.observe(this.#list.element);
    const visibility = (): void => this.#onVisibility();
    document.addEventListener("visibilitychange", visibility);
    this.#stops = [
      () => document.removeEventListener("visibilitychange", visibility),
      () => sizes.disconnect(),
      renderer.watch(() => this.#showFault()),
      this.#model.graph.watch((graph) => graph !== null && this.#offer(graph)),
    ];
    this.#showFault();
    this.#resume();
  }

  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
    window.clearTimeout(this.#hiddenTimer);
    this.#pause();
    this.#tools.hide();
  }

  close(): void {
    this.#scene.close();
    this.#tools.close();
  }

  config(): Record<string, unknown> {
    const { entries, fixedChoice, follow, followChoice, camera } = this.#scene;
    const shown = entries.filter(({ isOn }) => isOn);
    return {
      // Those that nobody has chosen are chosen again by what there is then.
      ...(this.#isAuto
        ? {}
        : {
            layers: shown.map(({ topic, type, kind, settings }) => ({
              topic,
              type,
              kind: kind.id,
              settings: { ...settings },
            })),
          }),
      frame: fixedChoice,
      follow,
      followFrame: followChoice,
      ...(this.#isPlaced ? { camera: camera.state } : {}),
      topics: { ...this.#tools.topics },
      ...(this.element.classList.contains("without-list") ? { list: false } : {}),
    };
  }

  #restore(config: Partial<Record<keyof Config, unknown>>): void {
    const { layers, frame, follow, followFrame, camera, topics } = config;
    if (typeof frame === "string") this.#scene.fixedChoice = frame;
    if (typeof followFrame === "string") this.#scene.followChoice = followFrame;
    if (follow === "position" || follow === "heading") this.#scene.setFollow(follow);
    this.#follow.value = this.#scene.follow;
    if (typeof camera === "object" && camera !== null) this.#scene.camera.restore(camera);
    for (const [tool, topic] of Object.entries(topics ?? {})) {
      if (tool in TOOLS && typeof topic === "string") this.#tools.topics[tool] = topic;
    }
    for (const saved of Array.isArray(layers) ? layers : []) {
      const { topic, type, kind: name, settings } = (saved ?? {}) as Partial<SavedLayer>;
      const id = own(FORMER_IDS, name ?? "") ?? name;
      const kind = LAYER_KINDS.find((each) => each.id === id);
      if (kind === undefined || typeof topic !== "string" || typeof type !== "string") continue;
      this.#scene.toggle(this.#scene.entry(kind, topic, type, settings), true);
    }
  }

  /** Offer the topics of the graph; the first ones are shown until somebody chooses. */
  #offer(graph: Graph): void {
    this.#scene.offer(graph);
    if (!this.#isAuto) return;
    const published = new Set(
      graph.topics.filter(({ publishers }) => publishers.length > 0).map(({ name }) => name),
    );
    let shown = this.#scene.entries.filter(({ isOn }) => isOn).length;
    let hasMap = false;
    for (const entry of this.#scene.entries) {
      const { kind, topic, isOn } = entry;
      const isOwn = topic === this.#topic;
      // Of several maps, such as those of costs, the first one is below all others.
      const isMap = kind.types.includes("nav_msgs/OccupancyGrid");
      const isWanted =
        isOwn ||
        (this.#topic === ""
          ? kind.isFirst === true &&
            (kind.isOwn === true || published.has(topic)) &&
            !(isMap && hasMap) &&
            shown < MAX_FIRST
          : kind.isContext === true && !(isMap && hasMap));
      if (isMap && (isWanted || isOn)) hasMap = true;
      if (isWanted && !isOn) {
        this.#scene.toggle(entry, true);
        shown += 1;
      }
    }
    this.#list.update();
  }

  #onVisibility(): void {
    window.clearTimeout(this.#hiddenTimer);
    if (document.hidden) this.#hiddenTimer = window.setTimeout(() => this.#pause(), HIDDEN);
    else this.#resume();
  }

  #resume(): void {
    this.#scene.show();
    window.clearInterval(this.#timer);
    this.#timer = window.setInterval(() => this.#tick(), TICK);
    this.#tick();
  }

  #pause(): void {
    this.#scene.hide();
    window.clearInterval(this.#timer);
    if (this.#hoverFrame !== undefined) cancelAnimationFrame(this.#hoverFrame);
    this.#hoverFrame = undefined;
  }

  /** Say why nothing is drawn; the list and the text are there nevertheless. */
  #showFault(): void {
    const { fault } = renderer;
    const text = fault === "" ? "" : `${fault} The layers are below as text.`;
    setText(this.#fault, text);
    this.#fault.hidden = fault === "";
    if (fault !== "") this.#text.open = true;
  }

  // What is shown beside the picture.

  #tick(): void {
    this.#list.update();
    this.#showFrames();
    const now = performance.now();
    if (now - this.#describedAt < (this.#text.open ? 1000 : DESCRIBED)) return;
    this.#describedAt = now;
    this.#describe();
  }

  #showFrames(): void {
    const { transforms, fixedFrame, fixedChoice } = this.#scene;
    const key = [fixedFrame, fixedChoice, ...transforms.names].join();
    if (key === this.#frames) return;
    this.#frames = key;
    replace(
      this.#fixed,
      h("option", { value: "" }, fixedChoice === "" ? `Frame: ${fixedFrame}` : "Frame: automatic"),
      ...[...new Set([...transforms.names, fixedChoice])]
        .filter((name) => name !== "")
        .map((name) => h("option", { value: name }, `Frame: ${name}`)),
    );
    this.#fixed.value = fixedChoice;
  }

  #describe(): void {
    const { fixedFrame } = this.#scene;
    const robot = this.#robotText();
    const lines = [`Fixed frame: ${fixedFrame}`, ...(robot === "" ? [] : [robot])];
    append(lines, this.#list.texts());
    setAttribute(this.#scene.canvas, "aria-label", `Scene. ${lines.join(". ")}`);
    if (!this.#text.open) return;
    replace(this.#lines, ...lines.map((line) => h("li", {}, line)));
  }

  #robotText(): string {
    const { transforms, fixedFrame, followFrame } = this.#scene;
    if (followFrame === "") return "";
    try {
      const { transform } = transforms.lookup(fixedFrame, followFrame);
      const { x, y } = transform.translation;
      const degrees = Math.round((rollPitchYaw(transform.rotation)[2] * 180) / Math.PI);
      return `${followFrame}: x ${x.toFixed(2)}, y ${y.toFixed(2)} m, ${degrees}°`;
    } catch (error) {
      return (error as Error).message;
    }
  }

  // The camera.

  #drawn(): void {
    if (!this.#isPlaced) this.#place();
    if (this.#pointer !== undefined) this.#showHover();
  }

  /** Begin behind the robot; without one, with all that there is, whenever that is more. */
  #place(): void {
    const scene = this.#scene;
    if (scene.placeBehindRobot()) {
      this.#isPlaced = true;
      return;
    }
    const layers = scene.entries.filter(({ isOn, frame }) => isOn && frame !== "");
    const fitted = [scene.fixedFrame, ...layers.map(({ topic }) => topic)].join();
    if (layers.length === 0 || fitted === this.#fitted) return;
    this.#fitted = fitted;
    scene.fit();
  }

  moved(): void {
    this.#isPlaced = true;
    this.#showModes();
    this.#scene.moved();
  }

  #modeButton(mode: "orbit" | "top", label: string): HTMLButtonElement {
    const look = (): void => {
      const scene = this.#scene;
      const isNewTop = mode === "top" && scene.camera.mode !== "top";
      scene.camera.look(mode === "top" ? "top" : "behind");
      // The distance that suits one of them rarely suits the other.
      if (isNewTop && scene.follow === "off") scene.fit();
      else if (isNewTop) scene.recenter();
      this.moved();
    };
    return h("button", { type: "button", onclick: look }, label);
  }

  #showModes(): void {
    for (const [mode, button] of Object.entries(this.#modes)) {
      const isOn = this.#scene.camera.mode === mode;
      button.classList.toggle("on", isOn);
      setAttribute(button, "aria-pressed", String(isOn));
    }
  }

  #fit(): void {
    this.#isPlaced = true;
    this.#scene.fit();
  }

  #setFollow(): void {
    this.#isPlaced = true;
    this.#scene.setFollow(this.#follow.value as Follow);
  }

  /** Esc ends the tool, wherever the focus is; as it is handled then, a large panel stays so. */
  #escape(event: KeyboardEvent): void {
    if (event.key !== "Escape") return;
    // The bar is hidden then.
    const hadFocus = this.#tools.bar.contains(document.activeElement);
    if (!this.#tools.escape()) return;
    event.preventDefault();
    if (hadFocus) this.#stage.focus();
  }

  #press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target !== this.#stage) return;
    if (!this.#tools.key(event) && !this.#key(event)) return;
    event.preventDefault();
  }

  /** Do what a key stands for; returns whether there is such a key. */
  #key(event: KeyboardEvent): boolean {
    const { camera } = this.#scene;
    if (moveByKey(camera, event)) {
      this.moved();
      return true;
    }
    const { key } = event;
    const views: Readonly<Record<string, "top" | "side" | "behind">> = {
      1: "top",
      2: "side",
      3: "behind",
    };
    const view = views[key];
    const tool = Object.entries(TOOLS).find(([, each]) => each.key === key)?.[0];
    if (view !== undefined) {
      camera.look(view);
      this.moved();
    } else if (key === "0") {
      this.#fit();
    } else if (key === "f") {
      const follows = ["off", "position", "heading"];
      const next = (follows.indexOf(this.#follow.value) + 1) % follows.length;
      this.#follow.value = follows[next] as string;
      this.#setFollow();
    } else if (tool !== undefined) {
      this.#tools.choose(tool as ToolName);
    } else {
      return false;
    }
    return true;
  }

  // The tools, and what is under the pointer.

  get camera(): Scene["camera"] {
    return this.#scene.camera;
  }

  get hasTool(): boolean {
    return this.#tools.chosen !== undefined;
  }

  pressed(at: Press): void {
    this.#tools.press(at);
  }

  dragged(at: Press): void {
    this.#tools.drag(at);
  }

  released(at: Press): void {
    this.#tools.release(at);
  }

  cancelled(): void {
    this.#tools.cancel();
  }

  hovered(at: Pointer | undefined): void {
    this.#pointer = at;
    if (at !== undefined) this.#tools.hover(at);
    if (at === undefined) setText(this.#hover, "");
    else this.#hoverFrame ??= requestAnimationFrame(() => this.#showHover());
  }

  #showHover(): void {
    this.#hoverFrame = undefined;
    const at = this.#pointer;
    if (at === undefined) return;
    const found = this.#scene.pick(at);
    const topic = found === undefined ? "" : `${found.entry.topic}: `;
    setText(this.#hover, topic + this.#textAt(at, found));
  }

  #textAt({ x, y }: Pointer, found: ReturnType<Scene["pick"]>): string {
    const place = found?.hit.place ?? this.#scene.camera.ground(x, y);
    const at = place === undefined ? "" : `${placeText(place)} in ${this.#scene.fixedFrame}`;
    return [found?.hit.text ?? "", at].filter((part) => part !== "").join(" · ");
  }

  /** Keep what is under the pointer in sight, with a way to its topic. */
  clicked(at: Pointer): void {
    const found = this.#scene.pick(at);
    if (found === undefined) return;
    const { topic } = found.entry;
    const link = h("a", { class: "mono", href: route("topics", topic) }, topic);
    replace(this.#tools.status, link, `: ${this.#textAt(at, found)}`);
  }

  /** Show or hide the list: beside the picture, or the drawer above it, which is closed at first. */
  #toggleList(): void {
    const isDrawer = getComputedStyle(this.#list.element).position === "absolute";
    this.element.classList.toggle(isDrawer ? "with-drawer" : "without-list");
  }
}
