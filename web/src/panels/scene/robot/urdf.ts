/**
 * Robot models in URDF: links, the joints between these, and what is drawn of them.
 *
 * Source: http://wiki.ros.org/urdf/XML.
 */
import { append } from "../../../lists";
import {
  IDENTITY,
  multiplied,
  product,
  type Quaternion,
  type Transform,
  type Vector,
} from "../../../transforms";
import type { Color } from "../colors";
import { readXml, type XmlElement } from "./xml";

const ROTATING = ["revolute", "continuous"];
/** The types of joints that have one position; others are treated as fixed, as in ROS. */
const MOVING = [...ROTATING, "prismatic"];
const TYPES = [...MOVING, "fixed", "floating", "planar"];
const MAX_LINKS = 10_000;

export type Geometry =
  | { readonly kind: "box"; readonly size: Vector }
  | { readonly kind: "cylinder"; readonly radius: number; readonly length: number }
  | { readonly kind: "sphere"; readonly radius: number }
  | { readonly kind: "mesh"; readonly uri: string; readonly scale: Vector };

/** Something that is drawn of a link. */
export interface Shape {
  /** In the link. */
  readonly origin: Transform;
  readonly geometry: Geometry;
  /** Of a visual element with a material that has one. */
  readonly color: Color | undefined;
}

export interface Link {
  readonly name: string;
  readonly visual: readonly Shape[];
  readonly collision: readonly Shape[];
}

/** How a joint follows another one: position = multiplier * other + offset. */
export interface Mimic {
  readonly joint: string;
  readonly multiplier: number;
  readonly offset: number;
}

export interface Joint {
  readonly name: string;
  readonly type: string;
  readonly parent: string;
  readonly child: string;
  /** The child in the parent at position 0. */
  readonly origin: Transform;
  /** Of length 1, in the child. */
  readonly axis: Vector;
  /** In radians or metres; infinite without a limit. */
  readonly lower: number;
  readonly upper: number;
  readonly mimic: Mimic | undefined;
}

export interface RobotModel {
  readonly name: string;
  readonly root: string;
  readonly links: ReadonlyMap<string, Link>;
  /** Those nearer to the root come first. */
  readonly joints: readonly Joint[];
}

/** Whether a joint has a position. */
export function moves({ type }: Joint): boolean {
  return MOVING.includes(type);
}

/** The child in the parent at a position in radians or metres. */
export function jointAt({ type, origin, axis: { x, y, z } }: Joint, position: number): Transform {
  if (ROTATING.includes(type)) {
    const half = Math.sin(position / 2);
    const rotation = { x: x * half, y: y * half, z: z * half, w: Math.cos(position / 2) };
    return multiplied(origin, { ...IDENTITY, rotation });
  }
  if (type === "prismatic") {
    const translation = { x: x * position, y: y * position, z: z * position };
    return multiplied(origin, { ...IDENTITY, translation });
  }
  return origin;
}

/** The positions of joints that are known, with those that follow them. */
export function positionsOf(
  { joints }: RobotModel,
  known: ReadonlyMap<string, number>,
): Map<string, number> {
  const found = new Map<string, number>();
  for (const joint of joints) {
    if (!moves(joint)) continue;
    const { name, mimic } = joint;
    const own = known.get(name);
    const other = mimic && known.get(mimic.joint);
    if (own !== undefined) found.set(name, own);
    else if (mimic !== undefined && other !== undefined) {
      found.set(name, mimic.multiplier * other + mimic.offset);
    }
  }
  return found;
}

/**
 * Where each link is.
 *
 * `placeOf` knows where some links are; the others hang on their parents, whose joints are at
 * `positions`, or 0.
 */
export function placesOf(
  model: RobotModel,
  positions: ReadonlyMap<string, number>,
  placeOf: (link: string) => Transform | undefined = () => undefined,
): Map<string, Transform> {
  const places = new Map([[model.root, placeOf(model.root) ?? IDENTITY]]);
  for (const joint of model.joints) {
    const parent = places.get(joint.parent) as Transform;
    const position = positions.get(joint.name) ?? 0;
    places.set(joint.child, placeOf(joint.child) ?? multiplied(parent, jointAt(joint, position)));
  }
  return places;
}

/** Read a model; throws an `XmlError` that says in which line what is wrong. */
export function readUrdf(text: string): RobotModel {
  const root = readXml(text);
  if (root.name !== "robot") throw root.fault(`expected <robot>, got <${root.name}>`);
  const colors = new Map<string, Color>();
  for (const element of root.all("material")) {
    const color = colorOf(element);
    if (color !== undefined) colors.set(element.required("name"), color);
  }
  const links = readLinks(root, colors);
  const joints = new Map<string, Joint>();
  /** By the child. */
  const above = new Map<string, Joint>();
  for (const element of root.all("joint")) {
    const joint = readJoint(element);
    const { name, parent, child } = joint;
    if (joints.has(name)) throw element.fault(`duplicate joint ${name}`);
    for (const link of [parent, child]) {
      if (!links.has(link)) throw element.fault(`joint ${name}: unknown link ${link}`);
    }
    const first = above.get(child);
    if (first !== undefined) {
      throw element.fault(`link ${child} has two parents, ${first.parent} and ${parent}`);
    }
    above.set(child, joint);
    joints.set(name, joint);
  }
  for (const { name, mimic } of joints.values()) {
    if (mimic !== undefined && !joints.has(mimic.joint)) {
      throw root.fault(`joint ${name} mimics the unknown joint ${mimic.joint}`);
    }
  }
  const roots = [...links.keys()].filter((link) => !above.has(link));
  const [top] = roots;
  if (top === undefined || roots.length > 1) {
    const found = roots.slice(0, 5).join(", ") || "none, since the joints are a loop";
    throw root.fault(`expected one link without a parent, got ${found}`);
  }
  const sorted = downFrom(top, [...joints.values()]);
  if (sorted.length < joints.size) {
    throw root.fault("some joints are a loop, which is not joined to the root");
  }
  return { name: root.get("name") ?? "", root: top, links, joints: sorted };
}

/** The joints that hang on a link, those nearer to it first. */
function downFrom(root: string, joints: readonly Joint[]): Joint[] {
  const below = new Map<string, Joint[]>();
  for (const joint of joints) {
    const others = below.get(joint.parent);
    if (others === undefined) below.set(joint.parent, [joint]);
    else others.push(joint);
  }
  const found = [...(below.get(root) ?? [])];
  for (const { child } of found) append(found, below.get(child) ?? []);
  return found;
}

function readLinks(root: XmlElement, colors: ReadonlyMap<string, Color>): Map<string, Link> {
  const links = new Map<string, Link>();
  for (const element of root.all("link")) {
    const name = element.required("name");
    if (links.has(name)) throw element.fault(`duplicate link ${name}`);
    if (links.size === MAX_LINKS) throw element.fault(`too many links (limit ${MAX_LINKS})`);
    const shapes = (kind: string): Shape[] =>
      element.all(kind).map((each) => readShape(each, colors));
    links.set(name, { name, visual: shapes("visual"), collision: shapes("collision") });
  }
  if (links.size === 0) throw root.fault("the robot has no <link>");
  return links;
}

function readShape(element: XmlElement, colors: ReadonlyMap<string, Color>): Shape {
  const geometry = element.first("geometry");
  if (geometry === undefined) throw element.fault(`<${element.name}> requires a <geometry>`);
  const material = element.first("material");
  return {
    origin: readOrigin(element),
    geometry: readGeometry(geometry),
    color: material && (colorOf(material) ?? colors.get(material.get("name") ?? "")),
  };
}

function readGeometry(element: XmlElement): Geometry {
  const [shape] = element.children;
  const size = (name: string): number => {
    const [value] = numbers(shape as XmlElement, name, 1);
    return value as number;
  };
  switch (shape?.name) {
    case "box":
      return { kind: "box", size: vector(shape, "size") };
    case "cylinder":
      return { kind: "cylinder", radius: size("radius"), length: size("length") };
    case "sphere":
      return { kind: "sphere", radius: size("radius") };
    case "mesh": {
      const scale = vector(shape, "scale", { x: 1, y: 1, z: 1 });
      return { kind: "mesh", uri: shape.required("filename"), scale };
    }
    default:
      throw element.fault(
        `expected <box>, <cylinder>, <sphere> or <mesh> in <geometry>, got ${shape === undefined ? "nothing" : `<${shape.name}>`}`,
      );
  }
}

function colorOf(material: XmlElement): Color | undefined {
  const element = material.first("color");
  if (element === undefined) return undefined;
  const [red = 0, green = 0, blue = 0, alpha = 1] = numbers(element, "rgba", 4);
  return [red, green, blue, alpha];
}

function readJoint(element: XmlElement): Joint {
  const [name, type] = [element.required("name"), element.required("type")];
  if (!TYPES.includes(type)) {
    throw element.fault(`joint ${name}: unknown type ${type}, expected ${TYPES.join(", ")}`);
  }
  const [parent, child] = ["parent", "child"].map((end) => {
    const found = element.all(end);
    const [first] = found;
    if (first === undefined || found.length > 1) {
      throw element.fault(`joint ${name} requires one <${end}>, got ${found.length}`);
    }
    return first.required("link");
  }) as [string, string];
  let [lower, upper] = [-Infinity, Infinity];
  const limit = element.first("limit");
  if (limit !== undefined && type !== "continuous") {
    lower = number(limit, "lower", 0);
    upper = number(limit, "upper", 0);
  }
  const mimic = element.first("mimic");
  return {
    name,
    type,
    parent,
    child,
    origin: readOrigin(element),
    axis: readAxis(element, name, type),
    lower,
    upper,
    mimic: mimic && {
      joint: mimic.required("joint"),
      multiplier: number(mimic, "multiplier", 1),
      offset: number(mimic, "offset", 0),
    },
  };
}

function readAxis(joint: XmlElement, name: string, type: string): Vector {
  const along = { x: 1, y: 0, z: 0 };
  const element = joint.first("axis");
  if (element === undefined) return along;
  const { x, y, z } = vector(element, "xyz", along);
  const length = Math.hypot(x, y, z);
  if (length === 0 && MOVING.includes(type)) {
    throw element.fault(`joint ${name}: the axis must not be 0 0 0`);
  }
  return length === 0 ? along : { x: x / length, y: y / length, z: z / length };
}

function readOrigin(element: XmlElement): Transform {
  const origin = element.first("origin");
  if (origin === undefined) return IDENTITY;
  const zero = { x: 0, y: 0, z: 0 };
  const { x: roll, y: pitch, z: yaw } = vector(origin, "rpy", zero);
  return { translation: vector(origin, "xyz", zero), rotation: ofRollPitchYaw(roll, pitch, yaw) };
}

/** A rotation about x, then about y, then about z, all of them fixed axes. */
export function ofRollPitchYaw(roll: number, pitch: number, yaw: number): Quaternion {
  const about = (axis: "x" | "y" | "z", angle: number): Quaternion => ({
    ...{ x: 0, y: 0, z: 0, w: Math.cos(angle / 2) },
    [axis]: Math.sin(angle / 2),
  });
  return product(product(about("z", yaw), about("y", pitch)), about("x", roll));
}

function vector(element: XmlElement, name: string, otherwise?: Vector): Vector {
  if (otherwise !== undefined && element.get(name) === undefined) return otherwise;
  const [x = 0, y = 0, z = 0] = numbers(element, name, 3);
  return { x, y, z };
}

function number(element: XmlElement, name: string, otherwise: number): number {
  return element.get(name) === undefined ? otherwise : (numbers(element, name, 1)[0] as number);
}

/** Finite numbers of an attribute. */
function numbers(element: XmlElement, name: string, count: number): number[] {
  const text = element.required(name);
  const found = text.trim().split(/\s+/).map(Number);
  if (found.length !== count || !found.every(Number.isFinite)) {
    const got = JSON.stringify(text.slice(0, 100));
    throw element.fault(`${name} must be ${count} finite numbers, got ${got}`);
  }
  return found;
}
