/** The tree of coordinate frames: who publishes what, how often, and what is wrong with it. */
import {
  IDENTITY,
  inverse,
  multiplied,
  type Transform,
  type TransformStamped,
  unit,
} from "../../transforms";

export interface Source {
  /** The node that has sent it; empty if that is unknown. */
  readonly node: string;
  readonly isStatic: boolean;
}

/** A frame with a parent. */
export interface Frame {
  readonly name: string;
  parent: string;
  isStatic: boolean;
  node: string;
  transform: Transform;
  /** In ms since 1970. */
  stamp: number;
  arrived: number;
  /** Messages per second. */
  rate: number;
  /** The parents of the last seconds, each with the time when it was named. */
  readonly parents: Map<string, number>;
  /** Messages since the rate was last computed, and when that was. */
  count: number;
  counted: number;
}

/** Most frames; more are not shown. */
export const MAX_FRAMES = 1000;
/** A moving frame is old after this time, in ms. */
const STALE = 1000;
/** Two parents count if both are named within this time, in ms. */
const PARENT_MEMORY = 5000;
/** How far the length of a quaternion may be from 1. */
const UNIT = 1e-3;
const RATE_WINDOW = 1000;

export class Frames {
  readonly #frames = new Map<string, Frame>();

  /** All frames with a parent, by their names. */
  get all(): ReadonlyMap<string, Frame> {
    return this.#frames;
  }

  /** The names of all frames, sorted. */
  get names(): string[] {
    const found = new Set<string>();
    for (const { name, parent } of this.#frames.values()) found.add(name).add(parent);
    return [...found].sort();
  }

  /** Take the transforms of a message that has arrived at `now`, in ms since 1970. */
  update(transforms: readonly TransformStamped[], { node, isStatic }: Source, now: number): void {
    for (const { header, child_frame_id, transform } of transforms) {
      // Frames of tf, before tf2, begin with a slash.
      const name = child_frame_id.replace(/^\//, "");
      const parent = header.frame_id.replace(/^\//, "");
      let frame = this.#frames.get(name);
      if (frame === undefined) {
        if (this.#frames.size >= MAX_FRAMES) continue;
        const times = { stamp: 0, arrived: now, counted: now };
        // The rate is that of the messages after the first.
        const empty = { rate: 0, count: -1, parents: new Map<string, number>() };
        frame = { name, parent, node, isStatic, transform, ...times, ...empty };
        this.#frames.set(name, frame);
      }
      const stamp = header.stamp.secs * 1000 + header.stamp.nsecs / 1e6;
      Object.assign(frame, { parent, node, isStatic, transform, stamp, arrived: now });
      frame.parents.set(parent, now);
      frame.count += 1;
    }
  }

  /** Compute the rates at `now`, in ms since 1970. */
  age(now: number): void {
    for (const frame of this.#frames.values()) {
      const time = now - frame.counted;
      if (time < RATE_WINDOW) continue;
      frame.rate = (frame.count * 1000) / time;
      frame.count = 0;
      frame.counted = now;
      for (const [parent, named] of frame.parents) {
        if (parent !== frame.parent && now - named > PARENT_MEMORY) frame.parents.delete(parent);
      }
    }
  }

  /** Forget all, as when simulated time begins again. */
  clear(): void {
    this.#frames.clear();
  }

  /** The frames without a parent, and one of each loop, sorted. */
  roots(): string[] {
    const roots = new Set<string>();
    for (const name of this.names) {
      const path = this.#pathOf(name);
      const last = path.at(-1) as string;
      // A loop has no root: the first of its names stands for it.
      const loop = this.#loopOf(last);
      roots.add(loop === undefined ? last : ([...loop].sort()[0] as string));
    }
    return [...roots].sort();
  }

  /** The frames directly below one, sorted. */
  childrenOf(name: string): Frame[] {
    return [...this.#frames.values()]
      .filter(({ parent }) => parent === name)
      .sort((a, b) => a.name.localeCompare(b.name));
  }

  /** What is wrong with a frame at `now`, in ms since 1970. */
  faultsOf({ name, isStatic, arrived, transform, parents }: Frame, now: number): string[] {
    const faults: string[] = [];
    if (parents.size > 1) faults.push(`has several parents: ${[...parents.keys()].join(", ")}`);
    if (this.#loopOf(name) !== undefined) faults.push("is in a loop");
    if (!isStatic && now - arrived > STALE) {
      faults.push(`no transform for ${((now - arrived) / 1000).toFixed(0)} s`);
    }
    const { x, y, z, w } = transform.rotation;
    const length = Math.hypot(x, y, z, w);
    if (!(Math.abs(length - 1) <= UNIT)) {
      faults.push(`the quaternion has the length ${Number(length.toPrecision(4))}, not 1`);
    }
    return faults;
  }

  /**
   * The newest transform of `source` in `target`: where `source` is, as tf_echo prints it.
   *
   * Throws an `Error` that says why there is none.
   */
  lookup(target: string, source: string): Transform {
    const known = new Set(this.names);
    for (const name of [target, source]) {
      if (!known.has(name)) throw new Error(`unknown frame “${name}”`);
    }
    const [up, down] = [this.#pathOf(target), this.#pathOf(source)];
    const common = up.find((name) => down.includes(name));
    if (common === undefined) {
      throw new Error(`${target} and ${source} are in two trees: ${up.at(-1)} and ${down.at(-1)}`);
    }
    return multiplied(inverse(this.#below(common, up)), this.#below(common, down));
  }

  /** The transform of the first frame of a path in one of the others. */
  #below(ancestor: string, path: readonly string[]): Transform {
    let found = IDENTITY;
    for (const name of path) {
      if (name === ancestor) break;
      const frame = this.#frames.get(name);
      if (frame !== undefined) found = multiplied(unit(frame.transform), found);
    }
    return found;
  }

  /** A frame and those above it; a loop is left where it begins again. */
  #pathOf(name: string): string[] {
    const path = [name];
    for (;;) {
      const parent = this.#frames.get(path.at(-1) as string)?.parent;
      if (parent === undefined || path.includes(parent)) return path;
      path.push(parent);
    }
  }

  /** The frames of the loop that a frame is in. */
  #loopOf(name: string): string[] | undefined {
    const path = this.#pathOf(name);
    return this.#frames.get(path.at(-1) as string)?.parent === name ? path : undefined;
  }
}
