/** The robot of a description in URDF, whose links are where tf or its joints have them. */
import { h, replace, setName, setText } from "../../../dom";
import { plural } from "../../../format";
import { subscribe } from "../../../messages/data_client";
import { floats } from "../../../messages/values";
import type { Graph, TopicInfo } from "../../../model";
import { applied, multiplied, type Transform, type Vector } from "../../../transforms";
import type { Color } from "../colors";
import type { Hit, Layer, LayerContext, Places, Pointer, Problems, View } from "../layer";
import { nearestPoint } from "../picking";
import { Meshes } from "../robot/mesh_client";
import {
  type Geometry,
  type Joint,
  type RobotModel as Model,
  moves,
  placesOf,
  positionsOf,
  readUrdf,
  type Shape,
} from "../robot/urdf";
import { type Solid, SolidBatch } from "../solid_batch";

const STRING = "std_msgs/String";
const JOINT_STATE = "sensor_msgs/JointState";
/** The least time between two states of joints, in ms, and how many wait. */
const [THROTTLE, QUEUE] = [30, 10];
/** The time from a change of the graph until the parameter is read again, in ms. */
const DELAY = 500;
/** The colour of links without a material, and that of what collides. */
const GREY: Color = [0.7, 0.71, 0.74, 1];
const COLLISION: Color = [1, 0.6, 0.1, 0.45];

/** The place of something that is drawn, by the link that it is on. */
interface Part {
  readonly link: string;
  readonly isCollision: boolean;
  readonly origin: Transform;
  readonly color: Color;
  readonly geometry: Geometry;
}

export class RobotModel implements Layer {
  readonly #context: LayerContext;
  readonly #batch = new SolidBatch();
  #meshes: Meshes;
  #text = "";
  #model: Model | undefined;
  #parts: readonly Part[] = [];
  /** Positions of joints that a node publishes, and those of the sliders. */
  readonly #published = new Map<string, number>();
  readonly #chosen = new Map<string, number>();
  #positions = new Map<string, number>();
  /** Where links were when they were last drawn, in the fixed frame. */
  #drawn: ReadonlyMap<string, Transform> = new Map();
  /** The topics that are subscribed to. */
  #topics = { description: "", joints: "" };
  #ends: (() => void)[] = [];
  #isActive = false;
  /** Before the parameter is read again. */
  #timer: number | undefined;
  #fault = "";
  readonly #element = h("div", { class: "scene-joints" });
  #shown = "";

  constructor(context: LayerContext) {
    this.#context = context;
    this.#meshes = this.#newMeshes();
  }

  #newMeshes(): Meshes {
    return new Meshes(this.#context.hub, () => this.#context.redraw());
  }

  resume(): void {
    if (this.#isActive) return;
    this.#isActive = true;
    const { hub, model } = this.#context;
    const stop = hub.state.watch((state) => {
      if (state === "open") void this.#readParameter();
    });
    const stopGraph = model.graph.watch((graph) => this.#follow(graph));
    this.#ends.push(stop, stopGraph);
  }

  pause(): void {
    this.#isActive = false;
    window.clearTimeout(this.#timer);
    this.#timer = undefined;
    for (const end of this.#ends) end();
    this.#ends = [];
    this.#topics = { description: "", joints: "" };
  }

  update(): void {
    // Another topic of joints may be chosen.
    this.#follow(this.#context.model.graph.value);
  }

  /** Read the parameter of this name, unless a topic has the description. */
  async #readParameter(): Promise<void> {
    window.clearTimeout(this.#timer);
    this.#timer = undefined;
    const { hub, topic } = this.#context;
    try {
      const request = { name: topic, default: '""' };
      const { value } = await hub.call<{ value: string }>(
        "/rosapi/get_param",
        "rosapi/GetParam",
        request,
      );
      const text: unknown = JSON.parse(value);
      if (this.#topics.description === "" && typeof text === "string") this.#describe(text);
    } catch (error) {
      console.debug(error);
    }
  }

  /** Subscribe to the topics that there are now. */
  #follow(graph: Graph | null): void {
    if (graph === null || !this.#isActive) return;
    const { hub, topic, settings } = this.#context;
    const published = (name: string, type: string): TopicInfo | undefined =>
      graph.topics.find(
        (each) => each.name === name && each.type === type && each.publishers.length > 0,
      );
    if (published(topic, STRING) !== undefined && this.#topics.description === "") {
      this.#topics.description = topic;
      this.#ends.push(subscribe(hub, { topic }, ({ data }) => this.#describe(String(data))));
    } else if (this.#topics.description === "") {
      // What has changed the graph may have set another description.
      this.#timer ??= window.setTimeout(() => void this.#readParameter(), DELAY);
    }
    const beside = `${topic.slice(0, topic.lastIndexOf("/"))}/joint_states`;
    const joints = String(settings.joints) || beside;
    if (published(joints, JOINT_STATE) === undefined || this.#topics.joints === joints) return;
    this.#topics.joints = joints;
    const wanted = { topic: joints, type: JOINT_STATE, throttle: THROTTLE, queue: QUEUE };
    const end = subscribe(hub, wanted, ({ name, position }) => {
      // After another topic was chosen, the old one counts no more.
      if (this.#topics.joints === joints) this.#move(name as string[], floats(position));
    });
    this.#ends.push(end);
  }

  #move(names: readonly string[], positions: ArrayLike<number>): void {
    for (const [at, name] of names.entries()) {
      const position = positions[at];
      if (position !== undefined && Number.isFinite(position)) this.#published.set(name, position);
    }
    this.#joint();
  }

  /** Compute the positions of all joints. */
  #joint(): void {
    if (this.#model === undefined) return;
    const known = new Map([...this.#chosen, ...this.#published]);
    this.#positions = positionsOf(this.#model, known);
    this.#context.redraw();
  }

  #describe(text: string): void {
    if (text === this.#text) return;
    this.#text = text;
    this.#fault = "";
    this.#meshes.close();
    this.#meshes = this.#newMeshes();
    this.#model = undefined;
    this.#parts = [];
    if (text.trim() !== "") {
      try {
        this.#model = readUrdf(text);
        this.#parts = partsOf(this.#model);
      } catch (error) {
        this.#fault = `the description is invalid: ${(error as Error).message}`;
      }
    }
    this.#joint();
    this.#context.redraw();
  }

  /** What comes before the names of links in tf. */
  get #prefix(): string {
    const { prefix } = this.#context.settings;
    return prefix === "" ? "" : `${prefix}/`;
  }

  /** Where links are in the fixed frame, by tf or by the joints above them. */
  #locate(places: Places): ReadonlyMap<string, Transform> {
    if (this.#model === undefined) return new Map();
    return placesOf(this.#model, this.#positions, (link) => places.placeNow(this.#prefix + link));
  }

  /** The joints that tf says nothing of. */
  #looseJoints(places: Places): readonly Joint[] {
    return (this.#model?.joints ?? []).filter(
      (joint) =>
        moves(joint) &&
        joint.mimic === undefined &&
        places.placeNow(this.#prefix + joint.child) === undefined,
    );
  }

  problems(places: Places): Problems {
    const root = this.#model?.root;
    const isLost = root !== undefined && places.placeNow(this.#prefix + root) === undefined;
    const origin = `the origin of ${places.fixedFrame}`;
    const warning = isLost ? `no tf for ${this.#prefix}${root}: shown at ${origin}` : "";
    const meshes = this.#parts.flatMap(({ geometry }) =>
      geometry.kind === "mesh" ? [geometry.uri] : [],
    );
    return { error: this.#fault || this.#meshes.faultOf(new Set(meshes)), warning };
  }

  draw(view: View): void {
    const { settings } = this.#context;
    if (this.#model === undefined) return;
    this.#drawn = this.#locate(view);
    const alpha = Number(settings.alpha);
    this.#batch.begin();
    for (const { link, isCollision, origin, color, geometry } of this.#parts) {
      if (settings[isCollision ? "collision" : "visual"] !== true) continue;
      const place = this.#drawn.get(link) as Transform;
      const tint: Color = [color[0], color[1], color[2], color[3] * alpha];
      const solid = solidOf(geometry, origin, tint);
      if (solid !== undefined) this.#batch.add(solid, place);
      else if (geometry.kind === "mesh") {
        const model = multiplied(place, origin);
        this.#meshes.draw(geometry.uri, model, geometry.scale, tint, !isCollision);
      }
    }
    this.#batch.draw();
  }

  facts(places: Places): string {
    const model = this.#model;
    if (model === undefined) return `no robot is loaded: there is no ${this.#context.topic}`;
    const parts = [`${model.name || "robot"}: ${plural(model.links.size, "link")}`];
    const moving = model.joints.filter(moves).length;
    if (moving > 0 && this.#looseJoints(places).length === 0)
      parts.push(`${plural(moving, "joint")} by tf`);
    else if (moving > 0) {
      const from = this.#published.size > 0 ? `by ${this.#topics.joints}` : "by the sliders in ⚙";
      parts.push(`${plural(moving, "joint")} ${from}`);
    }
    if (this.#meshes.loading > 0) parts.push(`loading ${plural(this.#meshes.loading, "mesh")}`);
    return parts.join(", ");
  }

  controls(): HTMLElement {
    return this.#element;
  }

  /** Sliders for joints that nobody moves, and what is missing. */
  updateControls(places: Places): void {
    const sliders = this.#published.size > 0 ? [] : this.#looseJoints(places);
    const faults = [...this.#meshes.faults].map(([uri, why]) => `${uri}: ${why}`);
    const key = JSON.stringify([sliders.map(({ name }) => name), faults]);
    if (key === this.#shown) return;
    this.#shown = key;
    replace(
      this.#element,
      ...faults.map((each) => h("p", { class: "small error" }, each)),
      ...sliders.map((joint) => this.#slider(joint)),
    );
  }

  #slider(joint: Joint): HTMLElement {
    const { name, type } = joint;
    const [low, high] = rangeOf(joint);
    const output = h("output", { class: "small mono" });
    const show = (value: number): void => {
      const isLength = type === "prismatic";
      const text = isLength ? `${value.toFixed(3)} m` : `${((value * 180) / Math.PI).toFixed(0)}°`;
      setText(output, text);
    };
    const value = this.#chosen.get(name) ?? Math.min(high, Math.max(low, 0));
    const input = h("input", {
      type: "range",
      min: low,
      max: high,
      step: (high - low) / 200,
      value,
      oninput: () => {
        this.#chosen.set(name, input.valueAsNumber);
        show(input.valueAsNumber);
        this.#joint();
      },
    });
    show(value);
    const label = h("span", { class: "mono" });
    setName(label, name);
    return h("label", { class: "field" }, label, input, output);
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const links = [...this.#drawn];
    const numbers = links.flatMap(
      ([
        ,
        {
          translation: { x, y, z },
        },
      ]) => [x, y, z],
    );
    const near = nearestPoint(view, pointer, ORIGIN, numbers, 3);
    const [link = ""] = (near && links[near.index]) ?? [];
    if (near === undefined) return undefined;
    const joint = this.#model?.joints.find(({ child }) => child === link);
    const position = joint && this.#positions.get(joint.name);
    const at = position === undefined ? "" : `, ${joint?.name} ${position.toFixed(3)}`;
    return { ...near, text: `link ${link}${at}` };
  }

  extent(view: View): Vector[] {
    const half = 0.2;
    return [...this.#locate(view).values()].flatMap((place) =>
      [-half, half].map((each) => applied(place, { x: each, y: each, z: each })),
    );
  }

  close(): void {
    this.pause();
    this.#batch.close();
    this.#meshes.close();
  }
}

const ORIGIN: Transform = {
  translation: { x: 0, y: 0, z: 0 },
  rotation: { x: 0, y: 0, z: 0, w: 1 },
};

function partsOf({ links }: Model): Part[] {
  const parts = (link: string, shapes: readonly Shape[], isCollision: boolean): Part[] =>
    shapes.map(({ origin, geometry, color }) => {
      return {
        link,
        isCollision,
        origin,
        geometry,
        color: isCollision ? COLLISION : (color ?? GREY),
      };
    });
  return [...links.values()].flatMap(({ name, visual, collision }) => [
    ...parts(name, visual, false),
    ...parts(name, collision, true),
  ]);
}

function solidOf(geometry: Geometry, origin: Transform, color: Color): Solid | undefined {
  switch (geometry.kind) {
    case "box":
      return { shape: "box", origin, size: geometry.size, color };
    case "cylinder": {
      const wide = 2 * geometry.radius;
      return { shape: "cylinder", origin, size: { x: wide, y: wide, z: geometry.length }, color };
    }
    case "sphere": {
      const wide = 2 * geometry.radius;
      return { shape: "sphere", origin, size: { x: wide, y: wide, z: wide }, color };
    }
    case "mesh":
      return undefined;
  }
}

/** The positions between which a slider moves a joint. */
function rangeOf({ type, lower, upper }: Joint): [number, number] {
  if (upper > lower && upper < Infinity && lower > -Infinity) return [lower, upper];
  return type === "prismatic" ? [-1, 1] : [-Math.PI, Math.PI];
}
