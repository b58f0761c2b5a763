/** The camera of the scene: it turns about a point, or looks straight down. Pure. */
import {
  applied,
  IDENTITY,
  inverse,
  rollPitchYaw,
  type Transform,
  turned,
  type Vector,
} from "../../transforms";
import { type Matrix, product } from "./matrix";

/** The vertical field of view, in radians. */
const FIELD = Math.PI / 4;
const SLOPE = Math.tan(FIELD / 2);
const MIN_DISTANCE = 0.05;
const MAX_DISTANCE = 1e5;
/** The angle from which the camera first looks down, from behind the robot. */
const START_PITCH = Math.PI / 4;
const START_DISTANCE = 10;
/** How far ahead of the robot it looks first, for a distance of 1. */
const AHEAD = 0.2;
/** The directions in which one looks down: with x to the right, and as from a robot. */
const NORTH_UP = Math.PI / 2;
/** The lowest angle for which dragging moves the ground as far as the pointer. */
const FLAT = 0.3;

export type Mode = "orbit" | "top";

/** What the camera goes along with: nothing, where a frame is, or also how it is turned. */
export type Follow = "off" | "position" | "heading";

/** A place on the picture, in pixels from its upper left corner, and the distance to the camera. */
export interface Spot {
  readonly x: number;
  readonly y: number;
  readonly depth: number;
}

export interface CameraState {
  readonly mode: Mode;
  readonly yaw: number;
  readonly pitch: number;
  readonly distance: number;
  readonly focus: readonly [number, number, number];
}

export class Camera {
  mode: Mode = "orbit";
  /** The direction in which it looks, in radians about z; along x first. */
  yaw = 0;
  /** How far it looks down, in radians. */
  pitch = START_PITCH;
  /** From the focus, in m. In both modes, things at the focus have the same size. */
  distance = START_DISTANCE;
  /** The point in the middle of the picture, in the frame of the anchor. */
  focus: Vector = { x: 0, y: 0, z: 0 };
  /** What it follows, in the fixed frame. */
  #anchor: Transform = IDENTITY;
  /** Of the picture, in CSS pixels. */
  width = 1;
  height = 1;
  #view: Matrix | undefined;
  #matrix: Matrix | undefined;

  resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.#move();
  }

  get state(): CameraState {
    const { mode, yaw, pitch, distance, focus } = this;
    return { mode, yaw, pitch, distance, focus: [focus.x, focus.y, focus.z] };
  }

  /** Take a state that was saved; parts that are invalid are left out. */
  restore(saved: Partial<Record<keyof CameraState, unknown>>): void {
    const { mode, yaw, pitch, distance, focus } = saved;
    if (mode === "orbit" || mode === "top") this.mode = mode;
    if (isNumber(yaw)) this.yaw = yaw;
    if (isNumber(pitch)) this.pitch = limited(pitch, -Math.PI / 2, Math.PI / 2);
    if (isNumber(distance)) this.distance = limited(distance, MIN_DISTANCE, MAX_DISTANCE);
    if (Array.isArray(focus) && focus.length === 3 && focus.every(isNumber)) {
      const [x, y, z] = focus as [number, number, number];
      this.focus = { x, y, z };
    }
    this.#move();
  }

  /**
   * Go along with a frame that is now at `frame`; returns whether the picture changes.
   *
   * `keep` if the picture is to stay as it is, because the frame is followed from now on.
   */
  follow(follow: Follow, frame: Transform | undefined, keep = false): boolean {
    if (follow !== "off" && frame === undefined) return false;
    const at = frame ?? IDENTITY;
    const anchor: Transform =
      follow === "off"
        ? IDENTITY
        : {
            translation: at.translation,
            rotation:
              follow === "heading" ? turned(rollPitchYaw(at.rotation)[2]) : IDENTITY.rotation,
          };
    const before = this.#anchor;
    if (JSON.stringify(anchor) === JSON.stringify(before)) return false;
    if (keep) {
      this.focus = applied(inverse(anchor), applied(before, this.focus));
      this.yaw += rollPitchYaw(before.rotation)[2] - rollPitchYaw(anchor.rotation)[2];
    }
    this.#anchor = anchor;
    this.#move();
    return true;
  }

  /** Look at the scene from above, from the side, or as in the beginning. */
  look(from: "top" | "side" | "behind"): void {
    this.mode = from === "top" ? "top" : "orbit";
    this.pitch = from === "side" ? 0 : START_PITCH;
    const isTurned = this.#anchor.rotation.w !== 1;
    this.yaw = from === "behind" || isTurned ? 0 : NORTH_UP;
    this.#move();
  }

  /** Look at a robot in the fixed frame, over its shoulder. */
  placeBehind({ translation, rotation }: Transform): void {
    const inside = inverse(this.#anchor);
    const yaw = rollPitchYaw(rotation)[2];
    const { x, y, z } = translation;
    const ahead = this.mode === "orbit" ? AHEAD * this.distance : 0;
    const focus = { x: x + ahead * Math.cos(yaw), y: y + ahead * Math.sin(yaw), z };
    this.focus = applied(inside, focus);
    if (this.mode === "orbit") this.yaw = yaw + rollPitchYaw(inside.rotation)[2];
    this.#move();
  }

  /** Bring what it follows into the middle; if it also turns with that, look over its shoulder. */
  recenter(follow: Follow): void {
    const isBehind = follow === "heading";
    const ahead = isBehind && this.mode === "orbit" ? AHEAD * this.distance : 0;
    this.focus = { x: ahead, y: 0, z: 0 };
    if (isBehind) this.yaw = 0;
    this.#move();
  }

  /** Turn by a movement of the pointer, in pixels. */
  turn(dx: number, dy: number): void {
    const scale = Math.PI / Math.max(200, Math.min(this.width, this.height));
    this.yaw -= dx * scale;
    if (this.mode === "orbit") {
      this.pitch = limited(this.pitch + dy * scale, -Math.PI / 2, Math.PI / 2);
    }
    this.#move();
  }

  /** Turn about the vertical, as the picture turns by an angle in radians. */
  spin(angle: number): void {
    this.yaw += angle;
    this.#move();
  }

  /** Move along the ground by a movement of the pointer, in pixels. */
  pan(dx: number, dy: number): void {
    const scale = this.scale;
    const down = Math.sin(this.#pitch);
    const steep = Math.sign(down || 1) * Math.max(Math.abs(down), FLAT);
    const [cosine, sine] = [Math.cos(this.yaw), Math.sin(this.yaw)];
    const right = -dx * scale;
    const ahead = (dy * scale) / steep;
    const { x, y, z } = this.focus;
    this.focus = { x: x + right * sine + ahead * cosine, y: y - right * cosine + ahead * sine, z };
    this.#move();
  }

  /** Go nearer by a factor below 1, toward what is at a place on the picture if there is one. */
  zoom(factor: number, x = this.width / 2, y = this.height / 2): void {
    const distance = limited(this.distance * factor, MIN_DISTANCE, MAX_DISTANCE);
    const ratio = distance / this.distance;
    const { z } = applied(this.#anchor, this.focus);
    const ground = this.ground(x, y, z);
    this.distance = distance;
    if (ground !== undefined) {
      const point = applied(inverse(this.#anchor), ground);
      const move = (to: number, from: number): number => to + (from - to) * ratio;
      this.focus = {
        x: move(point.x, this.focus.x),
        y: move(point.y, this.focus.y),
        z: this.focus.z,
      };
    }
    this.#move();
  }

  /** Show a ball in the fixed frame as large as the picture. */
  fit(center: Vector, radius: number): void {
    this.focus = applied(inverse(this.#anchor), center);
    const aspect = Math.min(1, this.width / this.height);
    this.distance = limited(radius / (SLOPE * aspect), MIN_DISTANCE, MAX_DISTANCE);
    this.#move();
  }

  /** From the fixed frame to that of the camera, which looks along -z. */
  get view(): Matrix {
    this.#view ??= this.#makeView();
    return this.#view;
  }

  get projection(): Matrix {
    const aspect = this.width / this.height;
    if (this.mode === "top") {
      const high = this.distance * SLOPE;
      // The camera is at the focus: what is above it is seen, too.
      const deep = Math.max(1000, 20 * this.distance);
      return [1 / (high * aspect), 0, 0, 0, 0, 1 / high, 0, 0, 0, 0, -1 / deep, 0, 0, 0, 0, 1];
    }
    const near = Math.max(0.01, this.distance / 100);
    const far = near * 20_000;
    const depth = 1 / (near - far);
    return [
      1 / (SLOPE * aspect),
      0,
      0,
      0,
      0,
      1 / SLOPE,
      0,
      0,
      0,
      0,
      (near + far) * depth,
      -1,
      0,
      0,
      2 * near * far * depth,
      0,
    ];
  }

  /** From the fixed frame to the picture's corners at -1 and 1. */
  get matrix(): Matrix {
    this.#matrix ??= product(this.projection, this.view);
    return this.#matrix;
  }

  /** Where a point of the fixed frame is on the picture; `undefined` if it is behind the camera. */
  project({ x, y, z }: Vector): Spot | undefined {
    const m = this.matrix;
    const row = (at: number): number =>
      (m[at] as number) * x +
      (m[at + 4] as number) * y +
      (m[at + 8] as number) * z +
      (m[at + 12] as number);
    const w = row(3);
    if (!(w > 0)) return undefined;
    return {
      x: ((row(0) / w + 1) * this.width) / 2,
      y: ((1 - row(1) / w) * this.height) / 2,
      depth: row(2) / w,
    };
  }

  /** The point at some height of the fixed frame that is at a place on the picture. */
  ground(x: number, y: number, height = 0): Vector | undefined {
    const v = this.view;
    const column = (at: number): Vector => ({
      x: v[at] as number,
      y: v[at + 4] as number,
      z: v[at + 8] as number,
    });
    const [right, up, back] = [column(0), column(1), column(2)];
    const eye = this.#eye;
    const a = (((2 * x) / this.width - 1) * this.width * SLOPE) / this.height;
    const b = (1 - (2 * y) / this.height) * SLOPE;
    const isTop = this.mode === "top";
    const k = isTop ? this.distance : 0;
    const from = {
      x: eye.x + (right.x * a + up.x * b) * k,
      y: eye.y + (right.y * a + up.y * b) * k,
      z: eye.z + (right.z * a + up.z * b) * k,
    };
    if (isTop) return { x: from.x, y: from.y, z: height };
    const direction = {
      x: right.x * a + up.x * b - back.x,
      y: right.y * a + up.y * b - back.y,
      z: right.z * a + up.z * b - back.z,
    };
    const t = (height - from.z) / direction.z;
    if (!(t > 0 && t < 1e6)) return undefined;
    return { x: from.x + t * direction.x, y: from.y + t * direction.y, z: height };
  }

  #move(): void {
    this.#view = undefined;
    this.#matrix = undefined;
  }

  /** The size of a pixel at the focus, in m. */
  get scale(): number {
    return (2 * this.distance * SLOPE) / this.height;
  }

  get #pitch(): number {
    return this.mode === "top" ? Math.PI / 2 : this.pitch;
  }

  /** The heading in the fixed frame. */
  get heading(): number {
    return this.yaw + rollPitchYaw(this.#anchor.rotation)[2];
  }

  /** The point in the middle of the picture, in the fixed frame. */
  get center(): Vector {
    return applied(this.#anchor, this.focus);
  }

  /** Where the camera is; from above, it is at the focus. */
  get #eye(): Vector {
    const focus = this.center;
    if (this.mode === "top") return focus;
    const flat = Math.cos(this.pitch) * this.distance;
    return {
      x: focus.x - flat * Math.cos(this.heading),
      y: focus.y - flat * Math.sin(this.heading),
      z: focus.z + Math.sin(this.pitch) * this.distance,
    };
  }

  #makeView(): Matrix {
    const [c, s] = [Math.cos(this.heading), Math.sin(this.heading)];
    const pitch = this.#pitch;
    const [flat, down] = [Math.cos(pitch), Math.sin(pitch)];
    const right = [s, -c, 0] as const;
    const up = [down * c, down * s, flat] as const;
    const back = [-flat * c, -flat * s, down] as const;
    const { x, y, z } = this.#eye;
    const along = (axis: readonly [number, number, number]): number =>
      -(axis[0] * x + axis[1] * y + axis[2] * z);
    return [
      right[0],
      up[0],
      back[0],
      0,
      right[1],
      up[1],
      back[1],
      0,
      right[2],
      up[2],
      back[2],
      0,
      along(right),
      along(up),
      along(back),
      1,
    ];
  }
}

function limited(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}

function isNumber(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value);
}
