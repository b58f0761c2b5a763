/** Tools that are used on the picture: a goal, a pose estimate, a point, and a distance. */
import { h, setText } from "../../dom";
import type { Publication } from "../../hub";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import { turned, type Vector } from "../../transforms";
import type { Press } from "./gestures";
import type { Pointer, View } from "./layer";
import { Arrows } from "./layers/arrows";
import { renderer, Vertices } from "./renderer";
import type { Scene } from "./scene";

export type ToolName = "goal" | "estimate" | "point" | "measure";

interface Tool {
  readonly label: string;
  readonly title: string;
  readonly key: string;
  readonly help: string;
  /** Where it publishes; a distance is only shown. */
  readonly topic?: string;
  readonly type?: string;
}

export const TOOLS: Readonly<Record<ToolName, Tool>> = {
  goal: {
    label: "Goal",
    title: "Send a goal",
    key: "g",
    help: "Press where the robot should go, drag to where it should look, release.",
    topic: "/move_base_simple/goal",
    type: "geometry_msgs/PoseStamped",
  },
  estimate: {
    label: "Pose",
    title: "Estimate the robot's pose",
    key: "p",
    help: "Press where the robot is, drag to where it looks, release.",
    topic: "/initialpose",
    type: "geometry_msgs/PoseWithCovarianceStamped",
  },
  point: {
    label: "Point",
    title: "Publish a point",
    key: "u",
    help: "Press on a point.",
    topic: "/clicked_point",
    type: "geometry_msgs/PointStamped",
  },
  measure: {
    label: "Measure",
    title: "Measure a distance",
    key: "m",
    help: "Drag from one point to another, or click both.",
  },
};

/** A drag that is shorter has no direction, in pixels. */
const MIN_DRAG = 6;
/** RViz's covariance of a pose estimate: of x and y in m², of the direction in rad². */
const COVARIANCE = [0.25, 0.25, (Math.PI / 12) ** 2] as const;
/** The lens on a finger: its size, its distance from the finger, and its zoom. */
const [LENS, LENS_ABOVE, LENS_ZOOM] = [96, 60, 2];
/** How far a key moves, in m for a pixel of the camera's scale, and turns, in radians. */
const [KEY_PIXELS, KEY_TURN] = [10, Math.PI / 36];

/** What a tool has been used for: from a point to another, in a frame. */
interface Mark {
  readonly tool: ToolName;
  readonly frame: string;
  from: Vector;
  to: Vector;
  /** The direction in radians; that of the drag, or of the camera without one. */
  yaw: number;
}

export class Tools {
  /** The buttons that choose a tool. */
  readonly buttons: readonly HTMLButtonElement[];
  /** What the chosen tool does, with its topic; and buttons to send by touch and keys. */
  readonly bar = h("div", { class: "scene-tool-bar", hidden: true });
  readonly lens = h("canvas", { class: "scene-lens", width: LENS, height: LENS, hidden: true });
  /** What has been sent or measured. */
  readonly status = h("p", { class: "small scene-tool-status", role: "status" });
  chosen: ToolName | undefined;
  readonly topics: Record<string, string> = {};
  readonly #scene: Scene;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #onChange: () => void;
  readonly #publications = new Map<string, Publication>();
  readonly #arrow = new Arrows();
  readonly #line = new Vertices();
  readonly #dot = new Vertices();
  readonly #help = h("span", { class: "small" });
  readonly #topic = h("input", {
    class: "mono",
    "aria-label": "Topic of the tool",
    spellcheck: "false",
    autocomplete: "off",
    onchange: () => this.#setTopic(),
  });
  readonly #send = h(
    "button",
    { type: "button", class: "primary", onclick: () => this.#finish() },
    "Send",
  );
  #mark: Mark | undefined;
  /** The place of the press, on the picture. */
  #pressed: Pointer | undefined;
  /** Whether the mark waits for Send. */
  #isWaiting = false;
  /** Whether a click has begun a measurement, which the next one ends. */
  #isHalf = false;

  constructor(scene: Scene, hub: DataSource, model: Model, onChange: () => void) {
    this.#scene = scene;
    this.#hub = hub;
    this.#model = model;
    this.#onChange = onChange;
    this.buttons = Object.entries(TOOLS).map(([name, { label, title, key }]) =>
      h(
        "button",
        {
          type: "button",
          "aria-pressed": "false",
          "aria-keyshortcuts": key,
          title: `${title} (${key})`,
          "data-tool": name,
          onclick: () => this.choose(name === this.chosen ? undefined : (name as ToolName)),
        },
        label,
      ),
    );
    this.bar.append(
      this.#help,
      this.#topic,
      this.#send,
      h("button", { type: "button", onclick: () => this.choose(undefined) }, "Cancel"),
    );
  }

  /** Choose a tool, or none. */
  choose(tool: ToolName | undefined): void {
    // What has been sent stays in the picture; what has not, and a measurement, is gone.
    if (this.#isWaiting || this.#mark?.tool === "measure") this.#mark = undefined;
    if (this.chosen === "measure") setText(this.status, "");
    this.#isWaiting = false;
    this.#isHalf = false;
    this.#pressed = undefined;
    this.lens.hidden = true;
    this.chosen = tool;
    for (const button of this.buttons) {
      const isChosen = button.dataset.tool === tool;
      button.setAttribute("aria-pressed", String(isChosen));
      button.classList.toggle("on", isChosen);
    }
    this.bar.hidden = tool === undefined;
    this.#send.hidden = true;
    if (tool !== undefined) {
      const { help, topic = "" } = TOOLS[tool];
      setText(this.#help, help);
      this.#topic.hidden = topic === "";
      this.#topic.value = this.topics[tool] ?? topic;
      if (topic !== "") this.#advertise(tool);
      setText(this.status, "");
    }
    this.#scene.redraw();
  }

  /** End: nothing is advertised any more. */
  hide(): void {
    this.choose(undefined);
    for (const publication of this.#publications.values()) publication.close();
    this.#publications.clear();
  }

  // The pointer and the keys.

  press({ x, y, isTouch }: Press): void {
    const tool = this.chosen;
    const place = this.#scene.camera.ground(x, y);
    if (tool === undefined || place === undefined) return;
    this.#pressed = { x, y };
    if (this.#isHalf && this.#mark !== undefined) {
      this.drag({ x, y, isTouch });
      return;
    }
    const yaw = this.#scene.camera.heading;
    this.#mark = { tool, frame: this.#scene.fixedFrame, from: place, to: place, yaw };
    this.#isWaiting = true;
    this.#showLens(isTouch ? { x, y } : undefined);
    this.#scene.redraw();
  }

  drag({ x, y, isTouch }: Press): void {
    const [mark, pressed] = [this.#mark, this.#pressed];
    const place = this.#scene.camera.ground(x, y);
    if (mark === undefined || pressed === undefined || place === undefined) return;
    mark.to = place;
    if (Math.hypot(x - pressed.x, y - pressed.y) >= MIN_DRAG) {
      mark.yaw = Math.atan2(place.y - mark.from.y, place.x - mark.from.x);
    }
    this.#showLens(isTouch ? { x, y } : undefined);
    this.#scene.redraw();
  }

  release(at: Press): void {
    const pressed = this.#pressed;
    if (pressed === undefined) return;
    this.drag(at);
    this.#pressed = undefined;
    this.lens.hidden = true;
    const isClick = Math.hypot(at.x - pressed.x, at.y - pressed.y) < MIN_DRAG;
    this.#isHalf = this.chosen === "measure" && isClick && !this.#isHalf;
    if (this.#isHalf) return;
    // A finger is not exact: what it has shown is sent by a button.
    if (at.isTouch && this.chosen !== "measure") this.#askToSend();
    else this.#finish();
  }

  /** Draw a measurement to where the pointer is, once its beginning has been clicked. */
  hover({ x, y }: Pointer): void {
    const place = this.#scene.camera.ground(x, y);
    if (!this.#isHalf || this.#mark === undefined || place === undefined) return;
    this.#mark.to = place;
    this.#scene.redraw();
  }

  cancel(): void {
    if (this.#isWaiting) this.#mark = undefined;
    this.#isWaiting = false;
    this.#isHalf = false;
    this.#pressed = undefined;
    this.lens.hidden = true;
    this.#send.hidden = true;
    this.#scene.redraw();
  }

  /** End the chosen tool; returns whether there is one. */
  escape(): boolean {
    if (this.chosen === undefined) return false;
    this.choose(undefined);
    return true;
  }

  /** Use the chosen tool by a key; returns whether it takes that key. */
  key({ key, shiftKey }: KeyboardEvent): boolean {
    const tool = this.chosen;
    if (tool === undefined) return false;
    const steps: Readonly<Record<string, readonly [number, number]>> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    const step = steps[key];
    if (step === undefined && key !== "Enter") return false;
    const mark = this.#isWaiting ? this.#mark : this.#newMark(tool);
    if (mark === undefined) return true;
    if (step !== undefined) this.#moveByKey(mark, step, shiftKey);
    else if (key === "Enter") this.#finish();
    this.#scene.redraw();
    return true;
  }

  /** A mark in the middle of the picture, which keys then move. */
  #newMark(tool: ToolName): Mark {
    const { camera, fixedFrame } = this.#scene;
    const place = { ...camera.center, z: 0 };
    const mark = { tool, frame: fixedFrame, from: place, to: place, yaw: camera.heading };
    this.#mark = mark;
    this.#askToSend();
    return mark;
  }

  #moveByKey(mark: Mark, [x, y]: readonly [number, number], isTurn: boolean): void {
    const { camera } = this.#scene;
    if (isTurn && mark.tool !== "measure") {
      mark.yaw -= x * KEY_TURN;
    } else {
      const step = camera.scale * KEY_PIXELS;
      const [cosine, sine] = [Math.cos(camera.heading), Math.sin(camera.heading)];
      const moved = ({ x: a, y: b, z }: Vector): Vector => ({
        x: a + step * (x * sine - y * cosine),
        y: b + step * (-x * cosine - y * sine),
        z,
      });
      if (mark.tool !== "measure" || isTurn) mark.from = moved(mark.from);
      mark.to = mark.tool === "measure" ? moved(mark.to) : mark.from;
    }
    setText(this.status, markText(mark));
  }

  #showLens(at: Pointer | undefined): void {
    this.lens.hidden = at === undefined;
    if (at === undefined) return;
    const { canvas } = this.#scene;
    const ratio = canvas.width / canvas.clientWidth;
    const size = LENS / LENS_ZOOM;
    this.lens.style.left = `${at.x - LENS / 2}px`;
    this.lens.style.top = `${at.y - LENS_ABOVE - LENS}px`;
    const context = this.lens.getContext("2d");
    const [left, top] = [(at.x - size / 2) * ratio, (at.y - size / 2) * ratio];
    context?.drawImage(canvas, left, top, size * ratio, size * ratio, 0, 0, LENS, LENS);
    context?.strokeRect(LENS / 2 - 4, LENS / 2 - 4, 8, 8);
  }

  // What is sent.

  #setTopic(): void {
    const tool = this.chosen;
    if (tool === undefined) return;
    this.topics[tool] = this.#topic.value.trim() || (TOOLS[tool].topic ?? "");
    this.#topic.value = this.topics[tool] ?? "";
    this.#advertise(tool);
    this.#onChange();
  }

  #topicOf(tool: ToolName): string {
    return this.topics[tool] ?? TOOLS[tool].topic ?? "";
  }

  /** Advertise when a tool is chosen: nodes of ROS 1 need time to connect. */
  #advertise(tool: ToolName): Publication | undefined {
    const { type } = TOOLS[tool];
    const topic = this.#topicOf(tool);
    if (type === undefined) return undefined;
    let publication = this.#publications.get(`${topic} ${type}`);
    if (publication === undefined) {
      publication = this.#hub.advertise(topic, type, (why) => {
        setText(this.status, `${topic}: ${why}`);
        this.#publications.delete(`${topic} ${type}`);
      });
      this.#publications.set(`${topic} ${type}`, publication);
    }
    return publication;
  }

  #askToSend(): void {
    this.#isWaiting = true;
    this.#send.hidden = this.chosen === "measure";
  }

  #finish(): void {
    const mark = this.#mark;
    if (mark === undefined || !this.#isWaiting) return;
    this.#isWaiting = false;
    this.#isHalf = false;
    const topic = this.#topicOf(mark.tool);
    if (mark.tool === "measure") {
      setText(this.status, markText(mark));
      this.#scene.redraw();
      return;
    }
    setText(this.status, `sent to ${topic}: ${markText(mark)}${this.#listeners(topic)}`);
    this.#advertise(mark.tool)?.publish(messageOf(mark));
    this.choose(undefined);
  }

  #listeners(topic: string): string {
    const found = this.#model.graph.value?.topics.find(({ name }) => name === topic);
    const others = found?.subscriptions.filter(({ node }) => !this.#hub.isOwn(node)) ?? [];
    return others.length === 0 ? " · no node subscribes to it" : "";
  }

  /** Draw what the tool is used for, which stays until it is used again. */
  draw(view: View): void {
    const mark = this.#mark;
    if (mark === undefined) return;
    const model = view.placeNow(mark.frame);
    if (model === undefined) return;
    const { accent } = view.theme;
    const { scale } = this.#scene.camera;
    const { from, to, yaw, tool } = mark;
    if (tool === "goal" || tool === "estimate") {
      const rotation = turned(yaw);
      this.#arrow.set([{ position: from, orientation: rotation }], 60 * scale, accent);
      this.#arrow.draw(model);
      return;
    }
    const size = 10 * scale;
    const dots = tool === "measure" ? [from, to] : [from];
    const numbers = dots.flatMap(({ x, y, z }) => [
      ...[x, y, z, 0, 0, 0, 1, size, size, size],
      ...accent,
    ]);
    this.#dot.set(Float32Array.from(numbers));
    renderer.solids({ shape: "sphere", vertices: this.#dot, count: dots.length }, model);
    if (tool !== "measure") return;
    this.#line.set(Float32Array.of(from.x, from.y, from.z, to.x, to.y, to.z));
    renderer.lines({ vertices: this.#line, count: 2, width: 3, color: accent }, model);
    view.label(markText(mark), to);
  }

  close(): void {
    this.#arrow.close();
    this.#line.close();
    this.#dot.close();
  }
}

function markText({ tool, from, to, yaw, frame }: Mark): string {
  if (tool === "measure") {
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    return `${Math.hypot(dx, dy).toFixed(2)} m (x ${dx.toFixed(2)}, y ${dy.toFixed(2)})`;
  }
  const direction = tool === "point" ? "" : `, ${Math.round((yaw * 180) / Math.PI)}°`;
  return `x ${from.x.toFixed(2)}, y ${from.y.toFixed(2)} m${direction} in ${frame}`;
}

function messageOf({ tool, frame, from, yaw }: Mark): Record<string, unknown> {
  const header = { stamp: "now", frame_id: frame };
  if (tool === "point") return { header, point: from };
  const pose = { position: from, orientation: turned(yaw) };
  if (tool === "goal") return { header, pose };
  const covariance = new Array<number>(36).fill(0);
  const [x, y, turn] = COVARIANCE;
  Object.assign(covariance, { 0: x, 7: y, 35: turn });
  return { header, pose: { pose, covariance } };
}
