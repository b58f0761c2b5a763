/** The scene: its layers, its frames, and when it is drawn. */

import { h } from "../../dom";
import { greatest, least } from "../../lists";
import { subscribe } from "../../messages/data_client";
import type { Graph, Model } from "../../model";
import type { DataSource } from "../../source";
import type { Transform, TransformStamped, Vector } from "../../transforms";
import { Camera, type Follow } from "./camera";
import type { Color } from "./colors";
import { Entry, type Surroundings } from "./entry";
import { LAYER_KINDS } from "./kinds";
import {
  type Hit,
  type KnownPlaces,
  type Label,
  type LayerKind,
  Places,
  type Pointer,
  type Theme,
  View,
} from "./layer";
import { type Lines, renderer, Vertices } from "./renderer";
import { frameName, TransformBuffer } from "./tf_buffer";

/** Most labels: of more, the scene shows none. */
const MAX_LABELS = 200;
/** How many messages of tf wait: each may be about other frames. */
const QUEUE = 1000;
/** After a picture that takes longer, the page has as much time for other things, in ms. */
const FAST = 8;
/** The camera rests if it has not moved for this time, in ms. */
const REST = 200;
/** The height of a label, and the width of a letter, in CSS pixels. */
const [LABEL_HEIGHT, LABEL_WIDTH] = [12, 6.5];
/** Lines of the ground on either side of its middle. */
const GROUND_LINES = 20;
/** The frames that a scene is fixed to, the best first. */
const FIXED_FRAMES = ["map", "odom", "world", "earth"];
/** Names of a robot's own frame, the best first. */
const ROBOT_FRAMES = ["base_footprint", "base_link", "base"];

export class Scene implements Surroundings {
  readonly hub: DataSource;
  readonly model: Model;
  readonly transforms = new TransformBuffer();
  readonly camera = new Camera();
  readonly canvas = h("canvas", { class: "scene-canvas", role: "img" });
  readonly labels = h("div", { class: "scene-labels", "aria-hidden": "true" });
  readonly entries: Entry[] = [];
  /** The frame to which the picture is fixed; empty to choose it by the frames there are. */
  fixedChoice = "";
  follow: Follow = "off";
  /** The frame to follow; empty for that of the robot. */
  followChoice = "";
  /** Draws above all layers, such as the arrow of a tool. */
  overlay: (view: View) => void = () => undefined;
  /** Called after each picture. */
  onDrawn: () => void = () => undefined;
  readonly #ground = new Vertices();
  #groundKey = "";
  readonly #known: KnownPlaces = new WeakMap();
  #theme: Theme | undefined;
  #view: View | undefined;
  #frame: number | undefined;
  #timer: number | undefined;
  #rest: number | undefined;
  #isMoving = false;
  /** Whether the followed frame comes into the middle as soon as it is known. */
  #isCentering = false;
  /** How long the last picture took, in ms, and when it was ready. */
  #last = { duration: 0, end: 0 };
  #isVisible = false;
  #isInSight = true;
  #stops: (() => void)[] = [];

  constructor(hub: DataSource, model: Model) {
    this.hub = hub;
    this.model = model;
  }

  /** Begin to draw, and to subscribe. */
  show(): void {
    if (this.#isVisible) return;
    this.#isVisible = true;
    // The colours may have changed meanwhile.
    this.#theme = undefined;
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const newTheme = (): void => {
      this.#theme = undefined;
      this.redraw();
    };
    dark.addEventListener("change", newTheme);
    const sizes = new ResizeObserver(() => this.redraw());
    sizes.observe(this.canvas);
    // What is scrolled away is not drawn.
    const places = new IntersectionObserver((found) => {
      this.#isInSight = found.at(-1)?.isIntersecting !== false;
      this.redraw();
    });
    places.observe(this.canvas);
    this.#stops = [
      renderer.watch(() => this.redraw()),
      this.hub.state.watch((state) => {
        // Meanwhile the robot may have moved, and its clock begun again.
        if (state !== "open") this.transforms.clear();
      }),
      this.hub.clock.onJump(() => {
        this.transforms.clear();
        for (const entry of this.entries) entry.clear();
        this.redraw();
      }),
      ...["/tf", "/tf_static"].map((topic) => this.#subscribe(topic)),
      () => dark.removeEventListener("change", newTheme),
      () => sizes.disconnect(),
      () => places.disconnect(),
    ];
    for (const entry of this.entries) if (entry.isOn) entry.start();
    this.redraw();
  }

  hide(): void {
    this.#isVisible = false;
    for (const stop of this.#stops) stop();
    this.#stops = [];
    for (const entry of this.entries) entry.pause();
    window.clearTimeout(this.#timer);
    window.clearTimeout(this.#rest);
    this.#isMoving = false;
    if (this.#frame !== undefined) cancelAnimationFrame(this.#frame);
    this.#timer = undefined;
    this.#frame = undefined;
  }

  /** Free the layers of a scene that is hidden. */
  close(): void {
    for (const entry of this.entries) entry.stop();
  }

  #subscribe(topic: string): () => void {
    const isStatic = topic === "/tf_static";
    return subscribe(this.hub, { topic, queue: QUEUE }, ({ transforms }) => {
      this.transforms.insert(transforms as TransformStamped[], isStatic);
      this.redraw();
    });
  }

  /** Offer what the graph has. */
  offer(graph: Graph): void {
    for (const kind of LAYER_KINDS) {
      for (const { name, type } of graph.topics) {
        if (kind.types.includes(type) && (kind.accepts?.(name) ?? true))
          this.entry(kind, name, type);
      }
      for (const name of kind.offers?.(graph) ?? []) this.entry(kind, name, "");
    }
  }

  /** The layer of a topic, which is added if there is none; `saved` are its settings then. */
  entry(
    kind: LayerKind,
    topic: string,
    type: string,
    saved?: Readonly<Record<string, unknown>>,
  ): Entry {
    let found = this.entries.find((each) => each.kind === kind && each.topic === topic);
    if (found === undefined) {
      found = new Entry(this, kind, topic, type, saved);
      this.entries.push(found);
      this.entries.sort(
        (a, b) =>
          LAYER_KINDS.indexOf(a.kind) - LAYER_KINDS.indexOf(b.kind) ||
          a.topic.localeCompare(b.topic),
      );
    }
    return found;
  }

  /** Show a layer, or hide it. */
  toggle(entry: Entry, isOn: boolean): void {
    if (!isOn) entry.stop();
    else if (this.#isVisible) entry.start();
    else entry.isOn = true;
    this.redraw();
  }

  get fixedFrame(): string {
    const { names } = this.transforms;
    if (this.fixedChoice !== "") return this.fixedChoice;
    const known = FIXED_FRAMES.find((name) => names.includes(name));
    if (known !== undefined) return known;
    if (names.length > 0) return this.#largestRoot();
    // Without tf, what is in one frame can be drawn together.
    const shown = this.entries.find(({ isOn, frame }) => isOn && frame !== "");
    return frameName(shown?.frame ?? "") || "map";
  }

  /** Of the frames without a parent, the one with the most children. */
  #largestRoot(): string {
    const children = new Map<string, number>();
    for (const name of this.transforms.names) {
      const parent = this.transforms.parentOf(name);
      if (parent !== undefined) children.set(parent, (children.get(parent) ?? 0) + 1);
    }
    const roots = [...children].filter(([name]) => this.transforms.parentOf(name) === undefined);
    // All are in loops.
    if (roots.length === 0) return this.transforms.names[0] as string;
    return roots.reduce((a, b) => (b[1] > a[1] ? b : a))[0];
  }

  /** The frame that the camera can follow; empty if there is none. */
  get followFrame(): string {
    if (this.followChoice !== "") return this.followChoice;
    const { names } = this.transforms;
    const isRobot = (name: string) => (each: string) => each === name || each.endsWith(`/${name}`);
    for (const name of ROBOT_FRAMES) {
      const found = names.find(isRobot(name));
      if (found !== undefined) return found;
    }
    return "";
  }

  /** Follow the robot, which comes into the middle; or nothing: the picture stays as it is. */
  setFollow(follow: Follow): void {
    this.follow = follow;
    this.recenter();
    if (follow === "off") this.camera.follow(follow, undefined, true);
  }

  /** Bring what is followed into the middle, once it is known where that is. */
  recenter(): void {
    this.#isCentering = this.follow !== "off";
    this.redraw();
  }

  /** Look at the robot from behind; returns whether there is one. */
  placeBehindRobot(): boolean {
    const robot = this.#followed();
    if (robot === undefined || this.followFrame === "") return false;
    this.camera.placeBehind(robot);
    this.redraw();
    return true;
  }

  #followed(): Transform | undefined {
    try {
      return this.transforms.lookup(this.fixedFrame, this.followFrame).transform;
    } catch {
      return undefined;
    }
  }

  /** The camera has moved: draw soon, and in full once it rests. */
  moved(): void {
    window.clearTimeout(this.#rest);
    this.#isMoving = true;
    this.#rest = window.setTimeout(() => {
      this.#isMoving = false;
      if (renderer.isSoftware) this.redraw();
    }, REST);
    this.redraw();
  }

  /** Draw soon, if anybody can see it. */
  redraw = (): void => {
    const isWaiting = this.#frame !== undefined || this.#timer !== undefined;
    if (!this.#isVisible || !this.#isInSight || isWaiting) return;
    const { duration, end } = this.#last;
    const rest = duration < FAST ? 0 : end + duration - performance.now();
    if (rest > 0) {
      this.#timer = window.setTimeout(() => {
        this.#timer = undefined;
        this.redraw();
      }, rest);
      return;
    }
    this.#frame = requestAnimationFrame(() => {
      this.#frame = undefined;
      const start = performance.now();
      this.#draw();
      const now = performance.now();
      this.#last = { duration: now - start, end: now };
    });
  };

  /** Where frames are now. */
  places(): Places {
    return new Places(this.fixedFrame, this.transforms, this.#known);
  }

  #newView(): View {
    this.#theme ??= themeOf(this.canvas);
    return new View(this.camera, this.fixedFrame, this.#theme, this.transforms, this.#known);
  }

  #draw(): void {
    const { canvas, camera } = this;
    const { clientWidth, clientHeight } = canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    const { ratio } = renderer;
    const [width, height] = [Math.round(clientWidth * ratio), Math.round(clientHeight * ratio)];
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    camera.resize(clientWidth, clientHeight);
    this.#follow();
    const view = this.#newView();
    this.#view = view;
    renderer.isHasty = this.#isMoving;
    renderer.draw(canvas, camera, view.theme.background, () => {
      this.#drawGround(view);
      for (const entry of this.entries) if (entry.isOn) entry.draw(view);
      this.overlay(view);
    });
    this.#showLabels(view.labels);
    this.onDrawn();
  }

  #follow(): void {
    const { camera, follow } = this;
    const frame = this.#followed();
    camera.follow(follow, frame, this.#isCentering);
    if (!this.#isCentering || frame === undefined) return;
    this.#isCentering = false;
    camera.recenter(follow);
  }

  /** Lines on the ground, whose distance is that of the camera's scale. */
  #drawGround({ theme }: View): void {
    const { camera } = this;
    const step = 10 ** Math.floor(Math.log10(Math.max(camera.distance, 0.1) / 2));
    const center = camera.center;
    const [x, y] = [center.x, center.y].map((each) => Math.round(each / step) * step) as [
      number,
      number,
    ];
    const key = [x, y, step].join();
    if (key !== this.#groundKey) {
      this.#groundKey = key;
      const reach = GROUND_LINES * step;
      const numbers: number[] = [];
      for (let at = -reach; at <= reach + step / 2; at += step) {
        numbers.push(at, -reach, 0, at, reach, 0, -reach, at, 0, reach, at, 0);
      }
      this.#ground.set(Float32Array.from(numbers));
    }
    const lines: Lines = {
      vertices: this.#ground,
      count: (2 * GROUND_LINES + 1) * 4,
      pairs: true,
      width: 1,
      color: theme.line,
      isGround: true,
    };
    renderer.lines(lines, { translation: { x, y, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } });
  }

  #showLabels(labels: readonly Label[]): void {
    const { clientWidth, clientHeight } = this.canvas;
    const seen = labels.filter(
      ({ spot: { x, y } }) => x >= 0 && y >= 0 && x <= clientWidth && y <= clientHeight,
    );
    const shown = seen.length > MAX_LABELS ? [] : spread(seen);
    while (this.labels.children.length > shown.length) this.labels.lastChild?.remove();
    while (this.labels.children.length < shown.length) this.labels.append(h("span", {}));
    for (const [at, { text, spot, color }] of shown.entries()) {
      const element = this.labels.children[at] as HTMLElement;
      if (element.textContent !== text) element.textContent = text;
      element.style.transform = `translate(${spot.x.toFixed(1)}px, ${spot.y.toFixed(1)}px)`;
      element.style.color = color ?? "";
    }
  }

  /** What is under the pointer, of the layer that it is nearest to. */
  pick(pointer: Pointer): { entry: Entry; hit: Hit } | undefined {
    const view = this.#view ?? this.#newView();
    let found: { entry: Entry; hit: Hit } | undefined;
    for (const entry of this.entries) {
      const hit = entry.isOn ? entry.layer?.pick?.(view, pointer) : undefined;
      if (hit !== undefined && (found === undefined || hit.distance <= found.hit.distance)) {
        found = { entry, hit };
      }
    }
    return found;
  }

  /** Show all that there is. */
  fit(): void {
    const view = this.#view ?? this.#newView();
    const points: Vector[] = this.entries.flatMap(({ isOn, layer }) =>
      isOn ? (layer?.extent?.(view) ?? []) : [],
    );
    if (points.length === 0) {
      this.camera.fit({ x: 0, y: 0, z: 0 }, 5);
    } else {
      const [x, y, z] = (["x", "y", "z"] as const).map((axis) => {
        const values = points.map((each) => each[axis]);
        return [least(values), greatest(values)] as const;
      }) as [readonly [number, number], readonly [number, number], readonly [number, number]];
      const middle = ([a, b]: readonly [number, number]): number => (a + b) / 2;
      const radius = Math.hypot(x[1] - x[0], y[1] - y[0], z[1] - z[0]) / 2;
      this.camera.fit({ x: middle(x), y: middle(y), z: middle(z) }, Math.max(radius, 0.5));
    }
    this.redraw();
  }
}

/** Move labels down that would cover others, such as those of frames at the same place. */
function spread(labels: readonly Label[]): Label[] {
  const placed: Label[] = [];
  for (const label of labels) {
    const { x } = label.spot;
    let { y } = label.spot;
    const covers = (other: Label): boolean =>
      // Less, since numbers are not exact: a label that was moved is free of the other.
      Math.abs(other.spot.y - y) < LABEL_HEIGHT - 1 &&
      other.spot.x < x + label.text.length * LABEL_WIDTH &&
      x < other.spot.x + other.text.length * LABEL_WIDTH;
    for (let other = placed.find(covers); other !== undefined; other = placed.find(covers)) {
      y = other.spot.y + LABEL_HEIGHT;
    }
    placed.push({ ...label, spot: { ...label.spot, y } });
  }
  return placed;
}

/** The colours of the page where an element is. */
function themeOf(element: Element): Theme {
  const style = getComputedStyle(element);
  const color = (name: string): Color => cssColor(element, style.getPropertyValue(name));
  return {
    background: color("--panel"),
    line: color("--line"),
    soft: color("--soft"),
    ink: color("--ink"),
    accent: color("--accent"),
  };
}

/** A colour of CSS, such as light-dark(…), as numbers. */
function cssColor(element: Element, value: string): Color {
  const probe = h("span", { hidden: true });
  probe.style.color = value;
  element.after(probe);
  const numbers = getComputedStyle(probe).color.match(/[\d.]+/g) ?? [];
  const [red = 0, green = 0, blue = 0] = numbers.map((each) => Number(each) / 255);
  probe.remove();
  return [red, green, blue, 1];
}
