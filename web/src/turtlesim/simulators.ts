/** The simulators in the graph, and where their turtles are. */
import type { Graph } from "../model";

/** The type of the service by which a simulator is found; ROS's own has it, too. */
export const SPAWN = "turtlesim/Spawn";
const POSE = "turtlesim/Pose";
/** The width and height of a simulator's picture, and its pixels per meter. */
export const PIXELS = 500;
export const METER = 45;
const SIZE = (PIXELS - 1) / METER;

export interface SimulatedTurtle {
  /** Its name in the simulator. */
  readonly name: string;
  /** The start of the names of its topics and services. */
  readonly base: string;
}

export interface Simulator {
  readonly node: string;
  /** The start of the names of its topics and services: `/`, or a namespace. */
  readonly prefix: string;
  /** The topic of what the pens have drawn; empty if it has none. */
  readonly picture: string;
  readonly turtles: readonly SimulatedTurtle[];
}

/** A message of turtlesim/Pose. */
export interface PoseMessage {
  x: number;
  y: number;
  theta: number;
  linear_velocity: number;
  angular_velocity: number;
}

/** The simulators, by the names of their nodes. */
export function simulatorsOf({ services, topics }: Graph): Simulator[] {
  return services
    .filter(({ name, type }) => type === SPAWN && name.endsWith("/spawn"))
    .map(({ name, node }) => {
      const prefix = name.slice(0, -"spawn".length);
      const own = topics.filter(({ publishers }) => publishers.some((each) => each.node === node));
      const picture = own.find((topic) => topic.name === `${node}/picture`)?.name ?? "";
      const turtles = own
        .filter((topic) => topic.type === POSE && topic.name.endsWith("/pose"))
        .map((topic) => topic.name.slice(0, -"/pose".length))
        .map((base) => ({ base, name: base.slice(base.startsWith(prefix) ? prefix.length : 0) }))
        .sort((one, other) => one.name.localeCompare(other.name, "en", { numeric: true }));
      return { node, prefix, picture, turtles };
    })
    .sort((one, other) => (one.node < other.node ? -1 : 1));
}

/** The transform that puts a turtle's shape, which looks to the right, where it is. */
export function transformOf({ x, y, theta }: PoseMessage): string {
  const [left, top] = [x * METER, (SIZE - y) * METER].map((each) => each.toFixed(2));
  return `translate(${left} ${top}) rotate(${((-theta * 180) / Math.PI).toFixed(2)})`;
}

/** A pose in words. */
export function textOf({ x, y, theta, linear_velocity, angular_velocity }: PoseMessage): string {
  const place = `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m, ${((theta * 180) / Math.PI).toFixed(0)}°`;
  const moves = linear_velocity !== 0 || angular_velocity !== 0;
  const speed = `${linear_velocity.toFixed(1)} m/s, ${angular_velocity.toFixed(1)} rad/s`;
  return moves ? `${place}; ${speed}` : place;
}
