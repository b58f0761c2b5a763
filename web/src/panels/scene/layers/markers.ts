/** Markers: visualization_msgs/Marker, MarkerArray, and interactive ones, which cannot be moved. */

import { h, replace } from "../../../dom";
import { plural } from "../../../format";
import { least } from "../../../lists";
import type { Fields } from "../../../messages/reader";
import {
  applied,
  IDENTITY,
  multiplied,
  rotated,
  type Transform,
  unit,
  type Vector,
} from "../../../transforms";
import type { Color } from "../colors";
import {
  firstProblems,
  type Hit,
  type Layer,
  type LayerContext,
  type Place,
  type Places,
  type Pointer,
  type Problems,
  REACH,
  type View,
} from "../layer";
import {
  type InteractiveMarker,
  type InteractiveMarkerPose,
  InteractiveMarkers,
  invisible,
  type Marker,
  MarkerSet,
  nameOf,
  type Rgba,
  type Shown,
  TYPES,
} from "../marker_set";
import type { Pose } from "../message";
import { nearestPoint } from "../picking";
import { renderer, Vertices } from "../renderer";
import { normalOf, packed } from "../robot/mesh";
import { Meshes } from "../robot/mesh_client";
import { type Solid, SolidBatch } from "../solid_batch";

/** The longest time of a timer, in ms. */
const MAX_TIMER = 2 ** 31 - 1;
/** The part of an arrow between two points that is its head, if its length is not given. */
const HEAD = 0.23;
/** How the namespace without a name is called. */
const NO_NAME = "(none)";

/** What is drawn of a marker, in its own frame. */
interface Drawn {
  /** Where it is in the frame of its header. */
  readonly pose: Transform;
  readonly solids: readonly Solid[];
  /** Lists: what the graphics card keeps. */
  readonly vertices: Vertices | undefined;
  /** Places that the pointer can be at, as x, y and z. */
  readonly places: Float32Array;
  /** Draw what is not a solid. */
  readonly draw: ((model: Transform, view: View) => void) | undefined;
}

export class Markers implements Layer {
  readonly #context: LayerContext;
  readonly #meshes: Meshes;
  readonly #set: MarkerSet<Drawn>;
  readonly #interactive = new InteractiveMarkers();
  readonly #batch = new SolidBatch();
  readonly #boxes = h("fieldset", { class: "scene-namespaces" });
  #namespaces = "";
  #timer: number | undefined;
  #expiry = Infinity;

  constructor(context: LayerContext) {
    this.#context = context;
    this.#meshes = new Meshes(context.hub, () => context.redraw());
    this.#set = new MarkerSet(
      (marker) => drawn(marker, this.#meshes),
      ({ vertices }) => vertices?.close(),
    );
  }

  receive(message: Fields, now: number): void {
    if ("server_id" in message) {
      const { server_id, markers } = message as unknown as {
        server_id: string;
        markers: InteractiveMarker[];
      };
      this.#interactive.init(server_id, markers);
      this.#showInteractive(now);
    } else {
      const markers =
        "markers" in message ? (message.markers as Marker[]) : [message as unknown as Marker];
      this.#apply(markers, now);
    }
  }

  clear(): void {
    this.#set.clear();
    this.#interactive.clear();
    this.#showNamespaces();
  }

  receiveUpdate(message: Fields, now: number): void {
    const { server_id, markers, poses, erases } = message as unknown as {
      server_id: string;
      markers: InteractiveMarker[];
      poses: InteractiveMarkerPose[];
      erases: string[];
    };
    if (this.#interactive.update(server_id, markers, poses, erases)) this.#showInteractive(now);
  }

  /** The wrong ones are left out; the error says which. */
  #apply(markers: readonly Marker[], now: number): void {
    let fault: unknown;
    for (const marker of markers) {
      try {
        this.#set.apply(marker, now);
      } catch (error) {
        fault ??= error;
      }
    }
    this.#showNamespaces();
    this.#wait(now);
    if (fault !== undefined) throw fault;
  }

  #showInteractive(now: number): void {
    this.#set.clear();
    this.#apply(this.#interactive.all.flatMap(plainMarkers), now);
  }

  /** Wait for the end of the next lifetime. */
  #wait(now: number): void {
    this.#expiry = this.#set.expire(now);
    window.clearTimeout(this.#timer);
    if (this.#expiry === Infinity) return;
    this.#timer = window.setTimeout(
      () => {
        this.#wait(this.#context.hub.clock.now());
        this.#showNamespaces();
        this.#context.redraw();
      },
      Math.min(MAX_TIMER, Math.max(0, this.#expiry - now)),
    );
  }

  get #hidden(): Set<string> {
    return new Set(
      String(this.#context.settings.hidden)
        .split(",")
        .map((each) => each.trim()),
    );
  }

  /** The markers whose namespaces are not hidden. */
  get #visible(): Shown<Drawn>[] {
    if (this.#context.settings.hidden === "") return [...this.#set];
    const hidden = this.#hidden;
    return [...this.#set].filter(({ marker }) => !hidden.has(settingName(marker.ns)));
  }

  draw(view: View): void {
    const locate = locator(view);
    const draws: (() => void)[] = [];
    this.#batch.begin();
    for (const { marker, drawn } of this.#visible) {
      const frame = locate(marker).transform;
      if (frame === undefined) continue;
      const model = multiplied(frame, drawn.pose);
      for (const solid of drawn.solids) this.#batch.add(solid, model);
      if (drawn.draw !== undefined) draws.push(() => drawn.draw?.(model, view));
    }
    this.#batch.draw();
    for (const draw of draws) draw();
  }

  problems(places: Places): Problems {
    const visible = this.#visible;
    const locate = locator(places);
    const meshes = new Set(visible.map(({ marker }) => marker.mesh_resource));
    return firstProblems([
      { error: this.#meshes.faultOf(meshes), warning: "" },
      ...visible.map(({ marker }) => {
        const { error, warning } = locate(marker);
        return { error, warning: invisible(marker) || warning };
      }),
    ]);
  }

  facts(): string {
    const { size, namespaces } = this.#set;
    const parts = [plural(size, "marker")];
    if (namespaces.length > 1) parts.push(`in ${namespaces.length} namespaces`);
    if (this.#interactive.all.length > 0) parts.push("which cannot be moved here");
    if (this.#meshes.loading > 0) parts.push("loading meshes");
    return parts.join(", ");
  }

  controls(): HTMLElement {
    this.#namespaces = "";
    this.#showNamespaces();
    return this.#boxes;
  }

  update(): void {
    this.#namespaces = "";
    this.#showNamespaces();
  }

  /** Boxes to tick, one for each namespace. */
  #showNamespaces(): void {
    const { settings } = this.#context;
    const found = this.#set.namespaces;
    const key = `${settings.hidden}\n${found.join("\n")}`;
    if (key === this.#namespaces) return;
    this.#namespaces = key;
    const hidden = this.#hidden;
    this.#boxes.hidden = found.length === 0;
    replace(
      this.#boxes,
      h("legend", { class: "small soft" }, "Namespaces"),
      ...found.map((name) => {
        const box = h("input", {
          type: "checkbox",
          checked: !hidden.has(settingName(name)),
          onchange: () => {
            const names = this.#hidden;
            if (box.checked) names.delete(settingName(name));
            else names.add(settingName(name));
            settings.hidden = [...names].filter((each) => each !== "").join(", ");
            this.#context.redraw();
          },
        });
        return h("label", {}, box, h("span", { class: "mono" }, name || NO_NAME));
      }),
    );
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    let found: Hit | undefined;
    const locate = locator(view);
    for (const { marker, drawn } of this.#set) {
      const frame = locate(marker).transform;
      if (frame === undefined) continue;
      const model = multiplied(frame, drawn.pose);
      const near = nearestPoint(view, pointer, model, drawn.places, 3);
      if (near === undefined || near.distance > Math.min(REACH, found?.distance ?? REACH)) continue;
      const point = drawn.places.length > 3 ? `, point ${near.index}` : "";
      const text = marker.text === "" ? "" : `: ${marker.text.slice(0, 100)}`;
      found = { ...near, text: `${nameOf(marker)} (${TYPES[marker.type]}${point})${text}` };
    }
    return found;
  }

  extent(view: View): Vector[] {
    const locate = locator(view);
    return [...this.#set].flatMap(({ marker, drawn }) => {
      const frame = locate(marker).transform;
      if (frame === undefined) return [];
      const model = multiplied(frame, drawn.pose);
      const { places } = drawn;
      const every = 3 * Math.max(1, Math.floor(places.length / 3000));
      const found: Vector[] = [];
      for (let at = 0; at + 2 < places.length; at += every) {
        const [x = 0, y = 0, z = 0] = places.subarray(at, at + 3);
        found.push(applied(model, { x, y, z }));
      }
      return found;
    });
  }

  pause(): void {
    window.clearTimeout(this.#timer);
  }

  resume(): void {
    this.#wait(this.#context.hub.clock.now());
  }

  close(): void {
    window.clearTimeout(this.#timer);
    this.#set.clear();
    this.#batch.close();
    this.#meshes.close();
  }
}

/** A function for the frame of a marker: where it was at the time of its stamp, or where it is now. */
function locator(places: Places): (marker: Marker) => Place {
  const now = new Map<string, Place>();
  return ({ header, frame_locked }) => {
    if (!frame_locked) return places.locate(header);
    const { frame_id } = header;
    let place = now.get(frame_id);
    if (place === undefined) {
      place = places.locateNow(frame_id);
      now.set(frame_id, place);
    }
    return place;
  };
}

/** A namespace as it is in the list of hidden ones. */
function settingName(name: string): string {
  return name.replaceAll(",", "%2C") || NO_NAME;
}

/** The markers of an interactive one, in its own namespace. */
function plainMarkers(interactive: InteractiveMarker): Marker[] {
  const { header, pose, name, controls } = interactive;
  const outer = transformOf(pose);
  return controls
    .flatMap(({ markers }) => markers)
    .map((marker, id) => {
      // Without a frame, a marker is at the pose of the interactive one.
      if (marker.header.frame_id !== "") return { ...marker, ns: name, id };
      const { translation, rotation } = multiplied(outer, transformOf(marker.pose));
      const inner = { position: translation, orientation: rotation };
      return { ...marker, header, pose: inner, ns: name, id };
    });
}

function transformOf({ position, orientation }: Pose): Transform {
  return unit({ translation: position, rotation: orientation });
}

function colorOf({ r, g, b, a }: Rgba): Color {
  return [r, g, b, a];
}

const ORIGIN = Float32Array.of(0, 0, 0);

/** What is drawn of a marker. */
function drawn(marker: Marker, meshes: Meshes): Drawn {
  const { scale, points, text } = marker;
  const pose = transformOf(marker.pose);
  const color = colorOf(marker.color);
  const base = { pose, solids: [], vertices: undefined, places: ORIGIN, draw: undefined };
  const solid = (shape: Solid["shape"]): Drawn => ({
    ...base,
    solids: [{ shape, origin: IDENTITY, size: scale, color }],
  });
  switch (TYPES[marker.type]) {
    case "arrow":
      return points.length < 2 ? solid("arrow") : { ...base, ...arrowBetween(marker, color) };
    case "cube":
      return solid("box");
    case "sphere":
      return solid("sphere");
    case "cylinder":
      return solid("cylinder");
    case "cube list":
      return { ...base, ...solidList(marker, "box") };
    case "sphere list":
      return { ...base, ...solidList(marker, "sphere") };
    case "line strip":
    case "line list":
      return { ...base, ...lines(marker, color) };
    case "points":
      return { ...base, ...pointList(marker, color) };
    case "triangle list":
      return { ...base, ...triangles(marker, color) };
    case "text": {
      const css = `rgb(${[...color.slice(0, 3)].map((each) => Math.round(each * 255)).join(" ")} / ${color[3]})`;
      return { ...base, draw: (model, view) => view.label(text, model.translation, css) };
    }
    default: {
      const { mesh_resource, mesh_use_embedded_materials: isOwn } = marker;
      // With its own colours, a mesh has that of the marker only if there is one.
      const tint: Color = isOwn && color[3] === 0 ? [0.8, 0.8, 0.8, 1] : color;
      return {
        ...base,
        draw: (model) => meshes.draw(mesh_resource, model, scale, tint, isOwn),
      };
    }
  }
}

function flat(points: readonly Vector[]): Float32Array {
  const found = new Float32Array(points.length * 3);
  for (const [at, { x, y, z }] of points.entries()) {
    found[3 * at] = x;
    found[3 * at + 1] = y;
    found[3 * at + 2] = z;
  }
  return found;
}

/** The scale of an arrow between two points: the thickness of its shaft and of its head. */
function arrowBetween(marker: Marker, color: Color): Partial<Drawn> {
  const [from, to] = marker.points as [Vector, Vector];
  const { x: shaft, y: wide, z } = marker.scale;
  const along = { x: to.x - from.x, y: to.y - from.y, z: to.z - from.z };
  const length = Math.hypot(along.x, along.y, along.z);
  if (!(length > 0 && length < Infinity)) return { places: flat([from]) };
  const head = Math.min(length, z === 0 ? HEAD * length : z);
  const rotation = zTo(along.x / length, along.y / length, along.z / length);
  const at = (distance: number): Transform => {
    const { x, y, z } = rotated(rotation, { x: 0, y: 0, z: distance });
    return { translation: { x: from.x + x, y: from.y + y, z: from.z + z }, rotation };
  };
  const rest = length - head;
  return {
    places: flat([from, to]),
    solids: [
      { shape: "cylinder", origin: at(rest / 2), size: { x: shaft, y: shaft, z: rest }, color },
      { shape: "cone", origin: at(rest + head / 2), size: { x: wide, y: wide, z: head }, color },
    ],
  };
}

/** The rotation that turns z to a direction of length 1. */
function zTo(x: number, y: number, z: number): Transform["rotation"] {
  // Half of the angle between them, about an axis that is upright on both.
  if (z < -1 + 1e-9) return { x: 1, y: 0, z: 0, w: 0 };
  return unit({ ...IDENTITY, rotation: { x: -y, y: x, z: 0, w: 1 + z } }).rotation;
}

function solidList(marker: Marker, shape: "box" | "sphere"): Partial<Drawn> {
  const { points, scale, colors, color } = marker;
  const vertices = new Vertices();
  const numbers = new Float32Array(points.length * 14);
  let isClear = false;
  for (const [at, { x, y, z }] of points.entries()) {
    const paint = colorOf(colors.length === points.length ? (colors[at] as Rgba) : color);
    isClear ||= paint[3] < 1;
    numbers.set([x, y, z, 0, 0, 0, 1, scale.x, scale.y, scale.z, ...paint], at * 14);
  }
  vertices.set(numbers);
  const list = { shape, vertices, count: points.length, isClear };
  return { vertices, places: flat(points), draw: (model) => renderer.solids(list, model) };
}

/** Points with 4 bytes of colour each: x, y, z and the colour in the order of `order`. */
function colored(marker: Marker, order: (color: Color) => Color): Float32Array {
  const { points, colors } = marker;
  const numbers = new Float32Array(points.length * 4);
  const bytes = new Uint32Array(numbers.buffer);
  for (const [at, { x, y, z }] of points.entries()) {
    numbers.set([x, y, z], at * 4);
    bytes[at * 4 + 3] = packed(order(colorOf(colors[at] as Rgba)));
  }
  return numbers;
}

function lines(marker: Marker, color: Color): Partial<Drawn> {
  const { points, colors, scale, type } = marker;
  const isColored = colors.length === points.length && colors.length > 0;
  const places = flat(points);
  const vertices = new Vertices(isColored ? colored(marker, (each) => each) : places);
  const all = {
    vertices,
    count: points.length,
    pairs: TYPES[type] === "line list",
    width: scale.x,
    isMetric: true,
    ...(isColored ? {} : { color }),
  };
  return { vertices, places, draw: (model) => renderer.lines(all, model) };
}

function pointList(marker: Marker, color: Color): Partial<Drawn> {
  const { points, colors, scale } = marker;
  const isColored = colors.length === points.length && colors.length > 0;
  const places = flat(points);
  const vertices = new Vertices(
    isColored ? colored(marker, ([red, green, blue, alpha]) => [blue, green, red, alpha]) : places,
  );
  const all = {
    vertices,
    count: points.length,
    stride: isColored ? 16 : 12,
    size: Math.max(scale.x, scale.y),
    isMetric: true,
    paint: isColored ? ({ kind: "bgr", offset: 12 } as const) : ({ kind: "flat", color } as const),
  };
  return { vertices, places, draw: (model) => renderer.points(all, model) };
}

/** Each three points are a triangle; colours are those of points, or of triangles. */
function triangles(marker: Marker, color: Color): Partial<Drawn> {
  const { points, colors, scale } = marker;
  const count = points.length - (points.length % 3);
  const perCorner = colors.length >= count;
  const perTriangle = !perCorner && colors.length * 3 === count;
  const numbers = new Float32Array(count * 7);
  const bytes = new Uint32Array(numbers.buffer);
  for (let at = 0; at < count; at += 3) {
    const three = [0, 1, 2].map((corner) => {
      const { x, y, z } = points[at + corner] as Vector;
      return [x * scale.x, y * scale.y, z * scale.z] as const;
    }) as unknown as Parameters<typeof normalOf>;
    const normal = normalOf(...three);
    for (const [corner, place] of three.entries()) {
      const index = at + corner;
      const own = perCorner ? colors[index] : perTriangle ? colors[at / 3] : undefined;
      numbers.set([...place, ...normal], index * 7);
      bytes[index * 7 + 6] = packed(own === undefined ? color : colorOf(own));
    }
  }
  const vertices = new Vertices(numbers);
  // The colours are those of the corners.
  const alpha =
    colors.length > 0
      ? least(
          colors.map(({ a }) => a),
          1,
        )
      : color[3];
  const white: Color = [1, 1, 1, alpha < 1 ? 0.999 : 1];
  const mesh = { vertices, count, color: white, hasColors: true };
  const places = new Float32Array(count * 3);
  for (let at = 0; at < count; at += 1) places.set(numbers.subarray(at * 7, at * 7 + 3), at * 3);
  return { vertices, places, draw: (model) => renderer.mesh(mesh, model) };
}
