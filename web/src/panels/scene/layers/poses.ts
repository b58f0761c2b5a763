/** Poses as arrows or axes, with their trail and their covariance. */

import { plural } from "../../../format";
import { append } from "../../../lists";
import type { Fields } from "../../../messages/reader";
import { floats } from "../../../messages/values";
import { Stamps } from "../../../simulated_time";
import {
  applied,
  IDENTITY,
  multiplied,
  rollPitchYaw,
  type Transform,
  turned,
  unit,
  type Vector,
} from "../../../transforms";
import { type Color, parseColor } from "../colors";
import {
  type Header,
  type Hit,
  type Layer,
  type LayerContext,
  NO_PROBLEMS,
  type Places,
  type Pointer,
  type Problems,
  type View,
} from "../layer";
import type { Pose } from "../message";
import { nearestPoint } from "../picking";
import { renderer, Vertices } from "../renderer";
import { Arrows, Axes } from "./arrows";

/** Places of a trail that are kept, and the least distance between two, in m. */
const MAX_TRAIL = 500;
const TRAIL_STEP = 0.02;
/** How many standard deviations a covariance is drawn with: 95 % of places are inside. */
const DEVIATIONS = 2;
export const FAN_STEPS = 16;

export class Poses implements Layer {
  readonly #context: LayerContext;
  readonly #arrows = new Arrows();
  readonly #axes = new Axes();
  readonly #ellipse = new Vertices();
  readonly #fan = new Vertices();
  readonly #trail = new Vertices();
  /** Places in the fixed frame of `#trailFrame`. */
  #places: number[] = [];
  #trailFrame = "";
  /** Whether messages have been missed, so that the next one begins a new trail. */
  #isTrailCut = false;
  readonly #stamps = new Stamps();
  #header: Header | undefined;
  #poses: readonly Pose[] = [];
  #covariance: Float32Array | undefined;
  #speed = "";

  constructor(context: LayerContext) {
    this.#context = context;
  }

  resume(): void {
    this.#isTrailCut = true;
  }

  receive(message: Fields): void {
    const header = message.header as Header;
    const isBack = this.#stamps.hasGoneBack(header.stamp.secs + header.stamp.nsecs / 1e9);
    if (this.#isTrailCut || isBack) this.#places = [];
    this.#isTrailCut = false;
    this.#header = header;
    this.#covariance = undefined;
    if (Array.isArray(message.poses)) {
      this.#poses = message.poses as Pose[];
    } else {
      const outer = message.pose as Pose | { pose: Pose; covariance: unknown };
      const hasCovariance = "covariance" in outer;
      this.#poses = [hasCovariance ? outer.pose : outer];
      // Zeros mean that the covariance is unknown.
      const found = hasCovariance ? floats(outer.covariance) : undefined;
      this.#covariance = found?.some((each) => each !== 0) ? found : undefined;
    }
    const { twist } = message as { twist?: { twist?: { linear: Vector; angular: Vector } } };
    if (twist?.twist !== undefined) {
      const { linear, angular } = twist.twist;
      const speed = Math.hypot(linear.x, linear.y, linear.z);
      this.#speed = `, ${speed.toFixed(2)} m/s, ${angular.z.toFixed(2)} rad/s`;
    }
    this.update();
  }

  update(): void {
    const { shape, size } = this.#context.settings;
    const isArrow = shape !== "axes";
    this.#arrows.set(isArrow ? this.#poses : [], Number(size), this.#color(1));
    this.#axes.set(isArrow ? [] : this.#poses, Number(size));
    if (this.#covariance !== undefined) this.#makeCovariance(this.#covariance);
  }

  #color(alpha: number): Color {
    return parseColor(String(this.#context.settings.color), alpha);
  }

  /** A flat ellipse for the place, and a fan for the direction. */
  #makeCovariance(numbers: Float32Array): void {
    const { a, b, angle } = ellipse(numbers[0] ?? 0, numbers[1] ?? 0, numbers[7] ?? 0);
    const q = turned(angle);
    const flat = [2 * DEVIATIONS * a, 2 * DEVIATIONS * b, 0.002];
    const box = [0, 0, 0, q.x, q.y, q.z, q.w, ...flat, ...this.#color(0.25)];
    this.#ellipse.set(Float32Array.from(box));
    const spread = Math.min(Math.PI, DEVIATIONS * Math.sqrt(Math.max(0, numbers[35] ?? 0)));
    const radius = Number(this.#context.settings.size);
    this.#fan.set(fan(radius, -spread, spread));
  }

  draw(view: View): void {
    const model = this.#header && view.place(this.#header);
    const { settings } = this.#context;
    if (model === undefined) return;
    this.#arrows.draw(model);
    this.#axes.draw(model);
    const [pose] = this.#poses;
    if (pose !== undefined && settings.covariance === true && this.#covariance !== undefined) {
      const { position, orientation } = pose;
      // The covariance is about the axes of the message's frame.
      const at = multiplied(model, { translation: position, rotation: IDENTITY.rotation });
      renderer.solids({ shape: "cylinder", vertices: this.#ellipse, count: 1, isClear: true }, at);
      const turned = multiplied(model, unit({ translation: position, rotation: orientation }));
      const color = this.#color(0.35);
      const count = FAN_STEPS * 3;
      renderer.mesh({ vertices: this.#fan, count, color, isFlat: true }, turned);
    }
    if (settings.trail === true && pose !== undefined) this.#drawTrail(view, model, pose);
  }

  #drawTrail(view: View, model: Transform, { position }: Pose): void {
    // Where it was is known only in the frame in which it was seen.
    if (view.fixedFrame !== this.#trailFrame) {
      this.#trailFrame = view.fixedFrame;
      this.#places = [];
    }
    const { x, y, z } = applied(model, position);
    const [a = Infinity, b = 0, c = 0] = this.#places.slice(-3);
    const step = Math.hypot(x - a, y - b, z - c);
    if (step >= TRAIL_STEP) {
      this.#places.push(x, y, z);
      if (this.#places.length > 3 * MAX_TRAIL) this.#places.splice(0, 3);
      this.#trail.set(Float32Array.from(this.#places));
    }
    const count = this.#places.length / 3;
    renderer.lines({ vertices: this.#trail, count, width: 2, color: this.#color(0.7) });
  }

  problems(places: Places): Problems {
    return this.#header === undefined ? NO_PROBLEMS : places.locate(this.#header);
  }

  facts(): string {
    const [pose] = this.#poses;
    if (this.#poses.length !== 1 || pose === undefined) return plural(this.#poses.length, "pose");
    return `${poseText(pose)}${this.#speed}`;
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const model = this.#header && view.place(this.#header);
    if (model === undefined) return undefined;
    const numbers = this.#poses.flatMap(({ position: { x, y, z } }) => [x, y, z]);
    const near = nearestPoint(view, pointer, model, numbers, 3);
    const pose = near && this.#poses[near.index];
    return pose && { ...near, text: poseText(pose) };
  }

  extent(view: View): Vector[] {
    const model = this.#header && view.place(this.#header);
    return model === undefined ? [] : this.#poses.map(({ position }) => applied(model, position));
  }

  close(): void {
    for (const each of [this.#arrows, this.#axes, this.#ellipse, this.#fan, this.#trail]) {
      each.close();
    }
  }
}

function poseText({ position: { x, y }, orientation }: Pose): string {
  const [, , yaw] = rollPitchYaw(unit({ ...IDENTITY, rotation: orientation }).rotation);
  return `x ${x.toFixed(2)}, y ${y.toFixed(2)} m, ${Math.round((yaw * 180) / Math.PI)}°`;
}

/** The half axes of the ellipse of one standard deviation, and how it is turned, in radians. */
export function ellipse(
  xx: number,
  xy: number,
  yy: number,
): { a: number; b: number; angle: number } {
  const middle = (xx + yy) / 2;
  const root = Math.hypot((xx - yy) / 2, xy);
  return {
    a: Math.sqrt(Math.max(0, middle + root)),
    b: Math.sqrt(Math.max(0, middle - root)),
    angle: Math.atan2(2 * xy, xx - yy) / 2,
  };
}

/** Triangles of a part of a disc, for `mesh`. */
export function fan(radius: number, from: number, to: number): Float32Array {
  const numbers: number[] = [];
  for (let step = 0; step < FAN_STEPS; step += 1) {
    const corner = (at: number): number[] => {
      const angle = from + ((to - from) * at) / FAN_STEPS;
      return [radius * Math.cos(angle), radius * Math.sin(angle), 0, 0, 0, 1];
    };
    append(numbers, [0, 0, 0, 0, 0, 1, ...corner(step), ...corner(step + 1)]);
  }
  return Float32Array.from(numbers);
}
