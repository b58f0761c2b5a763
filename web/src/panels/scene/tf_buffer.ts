/** The transforms of the last seconds: where each frame was in another one at a time. */
import {
  between,
  IDENTITY,
  inverse,
  multiplied,
  type Transform,
  type TransformStamped,
  unit,
} from "../../transforms";

/** How far the history of a frame reaches back from its newest transform, in ms, as in tf2. */
const HISTORY = 10_000;
/** Transforms of a frame that are nearer to each other need not all be kept, in ms. */
const SPACING = 20;
/** A stamp that is this much older than the newest one: time has begun again, in ms. */
const RESTART = 2000;
/** Most frames, and most transforms of a frame. */
export const MAX_FRAMES = 1000;
const MAX_SAMPLES = 4000;
/** Letters of a name that are compared with others. */
const MAX_NAME = 100;
/** Levels after which a frame is not searched further: it is in a loop. */
const MAX_DEPTH = 200;

interface Sample {
  /** In ms since 1970. */
  readonly stamp: number;
  readonly parent: string;
  readonly transform: Transform;
}

interface Place {
  /** Oldest first; one only if it is static. */
  samples: Sample[];
  isStatic: boolean;
}

export interface Found {
  readonly transform: Transform;
  /** How far the wanted time is from that of the transforms, in ms. */
  readonly apart: number;
}

/** One step from a frame to its parent. */
interface Step {
  readonly frame: string;
  /** The transform of the frame where the path began. */
  readonly transform: Transform;
  readonly apart: number;
}

/** Why there is no transform, for people. */
export class FrameError extends Error {}

/** The name of a frame without the slash that it had in tf, before tf2. */
export function frameName(name: string): string {
  return name.startsWith("/") ? name.slice(1) : name;
}

export class TransformBuffer {
  readonly #places = new Map<string, Place>();
  #names: string[] | undefined;

  /** Add the transforms of a message; `isStatic` if they are valid at all times. */
  insert(transforms: readonly TransformStamped[], isStatic: boolean): void {
    for (const { header, child_frame_id, transform } of transforms) {
      const name = frameName(child_frame_id);
      const parent = frameName(header.frame_id);
      if (name === "" || parent === "" || name === parent) continue;
      let place = this.#places.get(name);
      if (place === undefined) {
        if (this.#places.size >= MAX_FRAMES) continue;
        place = { samples: [], isStatic };
        this.#places.set(name, place);
        this.#names = undefined;
      }
      const stamp = header.stamp.secs * 1000 + header.stamp.nsecs / 1e6;
      const sample = { stamp, parent, transform: unit(transform) };
      if (place.samples.at(-1)?.parent !== parent) this.#names = undefined;
      if (isStatic || place.isStatic) {
        place.samples = [sample];
        place.isStatic = isStatic;
      } else {
        add(place.samples, sample);
      }
    }
  }

  /** Forget the frames that move: the static ones are sent only once. */
  clear(): void {
    for (const [name, { isStatic }] of this.#places) if (!isStatic) this.#places.delete(name);
    this.#names = undefined;
  }

  /** The names of all frames, sorted. */
  get names(): readonly string[] {
    if (this.#names === undefined) {
      const found = new Set(this.#places.keys());
      for (const name of this.#places.keys()) found.add(this.parentOf(name) as string);
      this.#names = [...found].sort();
    }
    return this.#names;
  }

  /** The frame above another one; `undefined` for roots and unknown frames. */
  parentOf(name: string): string | undefined {
    return this.#places.get(name)?.samples.at(-1)?.parent;
  }

  /** The stamp of a frame's newest transform, in ms since 1970; `undefined` if it is static. */
  stampOf(name: string): number | undefined {
    const place = this.#places.get(name);
    return place === undefined || place.isStatic ? undefined : place.samples.at(-1)?.stamp;
  }

  /**
   * Where `source` is in `target` at a time in ms since 1970; 0 is the newest.
   *
   * Of a time that the buffer does not have, the nearest. Throws a `FrameError` that says which
   * frame is missing.
   */
  lookup(target: string, source: string, stamp = 0): Found {
    if (target === source) return { transform: IDENTITY, apart: 0 };
    const down = this.#path(source, stamp);
    const up = this.#path(target, stamp);
    for (const to of up) {
      const from = down.find(({ frame }) => frame === to.frame);
      if (from === undefined) continue;
      return {
        transform: multiplied(inverse(to.transform), from.transform),
        apart: Math.max(to.apart, from.apart),
      };
    }
    for (const name of [source, target]) {
      if (!this.names.includes(name)) throw new FrameError(this.#missing(name));
    }
    throw new FrameError(
      `frame ${source} is not connected to ${target}: their roots are ${down.at(-1)?.frame} and ${up.at(-1)?.frame}`,
    );
  }

  /** A frame and those above it. */
  #path(name: string, stamp: number): Step[] {
    const path: Step[] = [{ frame: name, transform: IDENTITY, apart: 0 }];
    let last = path[0] as Step;
    while (path.length < MAX_DEPTH) {
      const place = this.#places.get(last.frame);
      if (place === undefined) break;
      const { parent, transform, apart } = at(place, stamp);
      last = {
        frame: parent,
        transform: multiplied(transform, last.transform),
        apart: Math.max(apart, last.apart),
      };
      path.push(last);
    }
    return path;
  }

  #missing(name: string): string {
    if (this.#places.size === 0) return `frame ${name} is unknown: there is no tf`;
    const near = nearest(name, this.names);
    const hint = near === undefined ? `known are ${some(this.names)}` : `did you mean ${near}?`;
    return `frame ${name} is not in the tree: ${hint}`;
  }
}

/** Add a sample to a history, which it begins again if it is much older. */
function add(samples: Sample[], sample: Sample): void {
  const { stamp } = sample;
  const last = samples.at(-1);
  if (last === undefined || stamp > last.stamp) {
    const before = samples.at(-2);
    // Of fast ones, some are enough to interpolate between.
    if (last !== undefined && before !== undefined && last.stamp - before.stamp < SPACING) {
      samples[samples.length - 1] = sample;
    } else {
      samples.push(sample);
    }
  } else if (stamp < last.stamp - RESTART) {
    samples.splice(0, samples.length, sample);
  } else {
    const place = indexOf(samples, stamp);
    samples.splice(place, samples[place]?.stamp === stamp ? 1 : 0, sample);
  }
  // In one go, since each removal moves all others.
  const oldest = (samples.at(-1) as Sample).stamp - HISTORY;
  const isLong = samples.length > MAX_SAMPLES;
  if (isLong || (samples[0] as Sample).stamp < oldest - HISTORY / 4) {
    samples.splice(0, Math.max(indexOf(samples, oldest), isLong ? MAX_SAMPLES / 4 : 0));
  }
}

/** The index of the first sample that is not older than a time. */
function indexOf(samples: readonly Sample[], stamp: number): number {
  let low = 0;
  let high = samples.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if ((samples[middle] as Sample).stamp < stamp) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The sample of a time: interpolated, or the nearest one. */
function at({ samples, isStatic }: Place, stamp: number): Sample & { apart: number } {
  const newest = samples.at(-1) as Sample;
  if (isStatic || stamp === 0) return { ...newest, apart: 0 };
  if (stamp >= newest.stamp) return { ...newest, apart: stamp - newest.stamp };
  const place = indexOf(samples, stamp);
  const after = samples[place] as Sample;
  const before = samples[place - 1];
  if (before === undefined) return { ...after, apart: after.stamp - stamp };
  // Between two parents, it is still below the first one.
  if (before.parent !== after.parent) return { ...before, apart: 0 };
  const ratio = (stamp - before.stamp) / (after.stamp - before.stamp);
  return { ...before, transform: between(before.transform, after.transform, ratio), apart: 0 };
}

/** The name that is most like another one; `undefined` if none is. */
export function nearest(name: string, names: readonly string[]): string | undefined {
  const plain = name.slice(0, MAX_NAME).toLowerCase();
  let found: string | undefined;
  // Other names have too little in common with it.
  let least = Math.max(2, Math.floor(plain.length / 3)) + 1;
  for (const each of names) {
    const other = each.slice(0, MAX_NAME).toLowerCase();
    const isPart = other.length > 2 && (plain.includes(other) || other.includes(plain));
    const edits = isPart ? 1 : distance(plain, other);
    if (edits < least) {
      least = edits;
      found = each;
    }
  }
  return found;
}

/** The fewest letters to insert, remove or replace to make one word of another. */
function distance(a: string, b: string): number {
  let row = Array.from({ length: b.length + 1 }, (_, at) => at);
  for (let i = 1; i <= a.length; i += 1) {
    const next = [i];
    for (let j = 1; j <= b.length; j += 1) {
      const replaced = (row[j - 1] as number) + (a[i - 1] === b[j - 1] ? 0 : 1);
      next.push(Math.min(replaced, (row[j] as number) + 1, (next[j - 1] as number) + 1));
    }
    row = next;
  }
  return row[b.length] as number;
}

function some(names: readonly string[]): string {
  const first = names.slice(0, 5).join(", ");
  return names.length > 5 ? `${first} and ${names.length - 5} more` : first;
}
