/** The markers of a topic, as publishers add, change and delete them. Pure. */
import type { Vector } from "../../transforms";
import type { Header, Stamp } from "./layer";
import type { Pose } from "./message";

/** Markers of a topic at most. */
const MAX_MARKERS = 20_000;

/** A std_msgs/ColorRGBA. */
export interface Rgba {
  readonly r: number;
  readonly g: number;
  readonly b: number;
  readonly a: number;
}

/** A visualization_msgs/Marker. */
export interface Marker {
  readonly header: Header;
  readonly ns: string;
  readonly id: number;
  readonly type: number;
  readonly action: number;
  readonly pose: Pose;
  readonly scale: Vector;
  readonly color: Rgba;
  readonly lifetime: Stamp;
  readonly frame_locked: boolean;
  readonly points: readonly Vector[];
  readonly colors: readonly Rgba[];
  readonly text: string;
  readonly mesh_resource: string;
  readonly mesh_use_embedded_materials: boolean;
}

/** The values of a marker's `type`, by their names in lower case. */
export const TYPES = [
  "arrow",
  "cube",
  "sphere",
  "cylinder",
  "line strip",
  "line list",
  "cube list",
  "sphere list",
  "points",
  "text",
  "mesh",
  "triangle list",
] as const;
export type MarkerType = (typeof TYPES)[number];

const [DELETE, DELETE_ALL] = [2, 3];

/** A marker that is shown. */
export interface Shown<T> {
  readonly marker: Marker;
  /** What the layer has made of it. */
  readonly drawn: T;
  /** When it ends, in ms since 1970. */
  readonly ends: number;
}

export class MarkerSet<T> {
  readonly #markers = new Map<string, Shown<T>>();
  readonly #make: (marker: Marker) => T;
  readonly #close: (drawn: T) => void;

  /** `make` is called for each marker that comes; `close` for each that goes. */
  constructor(make: (marker: Marker) => T, close: (drawn: T) => void) {
    this.#make = make;
    this.#close = close;
  }

  /** Take a marker; `now` is in ms since 1970. Throws an `Error` that says what is wrong with it. */
  apply(marker: Marker, now: number): void {
    const { ns, id, action, type, lifetime } = marker;
    if (action === DELETE_ALL) {
      // Of all namespaces, as RViz does.
      this.clear();
      return;
    }
    const key = `${id} ${ns}`;
    if (action === DELETE) {
      this.#remove(key);
      return;
    }
    if (action !== 0) throw new Error(`${nameOf(marker)}: unknown action ${action}`);
    if (TYPES[type] === undefined) throw new Error(`${nameOf(marker)}: unknown type ${type}`);
    if (this.#markers.size >= MAX_MARKERS && !this.#markers.has(key)) {
      throw new Error(`too many markers (limit ${MAX_MARKERS})`);
    }
    const drawn = this.#make(marker);
    this.#remove(key);
    const time = lifetime.secs * 1000 + lifetime.nsecs / 1e6;
    this.#markers.set(key, { marker, drawn, ends: time > 0 ? now + time : Infinity });
  }

  /** Remove those whose lifetime is over; returns when the next one ends. */
  expire(now: number): number {
    let next = Infinity;
    for (const [key, { ends }] of this.#markers) {
      if (ends <= now) this.#remove(key);
      else next = Math.min(next, ends);
    }
    return next;
  }

  clear(): void {
    for (const key of [...this.#markers.keys()]) this.#remove(key);
  }

  #remove(key: string): void {
    const known = this.#markers.get(key);
    if (known === undefined) return;
    this.#markers.delete(key);
    this.#close(known.drawn);
  }

  get size(): number {
    return this.#markers.size;
  }

  [Symbol.iterator](): Iterator<Shown<T>> {
    return this.#markers.values();
  }

  /** All namespaces, sorted. */
  get namespaces(): string[] {
    return [...new Set([...this].map(({ marker }) => marker.ns))].sort();
  }
}

/** How a marker is called: `marker walls/7`. */
export function nameOf({ ns, id }: Marker): string {
  return `marker ${ns === "" ? "" : `${ns}/`}${id}`;
}

/** Why a marker cannot be seen; empty if it can. */
export function invisible(marker: Marker): string {
  const { type, scale, color, colors, points, text } = marker;
  const name = TYPES[type];
  const { x, y, z } = scale;
  const isLine = name === "line strip" || name === "line list";
  const needed = name === "text" ? [z] : isLine ? [x] : name === "points" ? [x, y] : [x, y, z];
  // The head of an arrow between two points has a length of its own.
  const used = name === "arrow" && points.length === 2 ? [x, y] : needed;
  if (used.some((each) => each === 0)) return `${nameOf(marker)} has a scale of 0`;
  const isOwn = marker.mesh_use_embedded_materials && name === "mesh";
  if (color.a === 0 && colors.length === 0 && !isOwn) {
    return `${nameOf(marker)} has the alpha 0, which nobody can see`;
  }
  if (name === "text" && text === "") return `${nameOf(marker)} has no text`;
  return "";
}

/** A visualization_msgs/InteractiveMarker. */
export interface InteractiveMarker {
  readonly header: Header;
  readonly pose: Pose;
  readonly name: string;
  readonly description: string;
  readonly scale: number;
  readonly controls: readonly { readonly markers: readonly Marker[] }[];
}

/** A visualization_msgs/InteractiveMarkerPose. */
export interface InteractiveMarkerPose {
  readonly header: Header;
  readonly pose: Pose;
  readonly name: string;
}

/** The interactive markers of a topic; each belongs to a server. */
export class InteractiveMarkers {
  readonly #markers = new Map<string, Map<string, InteractiveMarker>>();

  /** Take all markers of a server. */
  init(server: string, markers: readonly InteractiveMarker[]): void {
    this.#markers.set(server, new Map(markers.map((each) => [each.name, each])));
  }

  /** Take the changes of a server; returns whether there are any. */
  update(
    server: string,
    markers: readonly InteractiveMarker[],
    poses: readonly InteractiveMarkerPose[],
    erases: readonly string[],
  ): boolean {
    const known = this.#markers.get(server) ?? new Map<string, InteractiveMarker>();
    this.#markers.set(server, known);
    for (const marker of markers) known.set(marker.name, marker);
    for (const { name, pose, header } of poses) {
      const marker = known.get(name);
      if (marker !== undefined) known.set(name, { ...marker, pose, header });
    }
    for (const name of erases) known.delete(name);
    return markers.length + poses.length + erases.length > 0;
  }

  clear(): void {
    this.#markers.clear();
  }

  get all(): InteractiveMarker[] {
    return [...this.#markers.values()].flatMap((each) => [...each.values()]);
  }
}
