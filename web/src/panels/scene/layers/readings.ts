/** Single readings: geometry_msgs/PointStamped, sensor_msgs/Range, and twists and wrenches. */
import type { Fields } from "../../../messages/reader";
import { applied, IDENTITY, type Vector } from "../../../transforms";
import { parseColor } from "../colors";
import {
  type Header,
  type Layer,
  type LayerContext,
  NO_PROBLEMS,
  type Places,
  type Problems,
  type View,
} from "../layer";
import { renderer, Vertices } from "../renderer";
import { FAN_STEPS, fan } from "./poses";

export class Point implements Layer {
  readonly #context: LayerContext;
  readonly #vertices = new Vertices();
  #header: Header | undefined;
  #point: Vector = IDENTITY.translation;

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields): void {
    this.#header = message.header as Header;
    this.#point = message.point as Vector;
    this.update();
  }

  update(): void {
    const { x, y, z } = this.#point;
    const size = Number(this.#context.settings.size);
    const paint = parseColor(String(this.#context.settings.color));
    this.#vertices.set(Float32Array.of(x, y, z, 0, 0, 0, 1, size, size, size, ...paint));
  }

  draw(view: View): void {
    const model = this.#header && view.place(this.#header);
    if (model !== undefined) {
      renderer.solids({ shape: "sphere", vertices: this.#vertices, count: 1 }, model);
    }
  }

  problems(places: Places): Problems {
    return this.#header === undefined ? NO_PROBLEMS : places.locate(this.#header);
  }

  facts(): string {
    const { x, y, z } = this.#point;
    return `${[x, y, z].map((each) => each.toFixed(2)).join(", ")} m`;
  }

  extent(view: View): Vector[] {
    const model = this.#header && view.place(this.#header);
    return model === undefined ? [] : [applied(model, this.#point)];
  }

  close(): void {
    this.#vertices.close();
  }
}

/** The cone of a sonar, seen from above: along x of its frame. */
export class Range implements Layer {
  readonly #context: LayerContext;
  readonly #vertices = new Vertices();
  #header: Header | undefined;
  #range = 0;
  #facts = "";

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields): void {
    const {
      range = 0,
      field_of_view = 0,
      min_range = 0,
      max_range = 0,
    } = message as Record<string, number>;
    this.#header = message.header as Header;
    // REP 117: without a measured distance, -inf is something that is near.
    const isHit = range === -Infinity || (range >= min_range && range <= max_range);
    this.#range = Math.min(Math.max(range, min_range), max_range);
    this.#facts = isHit
      ? `${this.#range.toFixed(2)} m`
      : `nothing from ${min_range} to ${max_range} m`;
    this.#vertices.set(fan(this.#range, -field_of_view / 2, field_of_view / 2));
  }

  draw(view: View): void {
    const model = this.#header && view.place(this.#header);
    if (model === undefined) return;
    const color = parseColor(String(this.#context.settings.color), 0.5);
    const count = FAN_STEPS * 3;
    renderer.mesh({ vertices: this.#vertices, count, color, isFlat: true }, model);
  }

  problems(places: Places): Problems {
    return this.#header === undefined ? NO_PROBLEMS : places.locate(this.#header);
  }

  facts(): string {
    return this.#facts;
  }

  extent(view: View): Vector[] {
    const model = this.#header && view.place(this.#header);
    return model === undefined ? [] : [applied(model, { x: this.#range, y: 0, z: 0 })];
  }

  close(): void {
    this.#vertices.close();
  }
}

/** The two vectors of a twist or a wrench, from the origin of its frame. */
export class Vectors implements Layer {
  readonly #context: LayerContext;
  readonly #lines = [new Vertices(), new Vertices()] as const;
  #header: Header | undefined;
  #vectors: readonly Vector[] = [];

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields): void {
    this.#header = message.header as Header;
    const { twist, wrench } = message as Record<string, Record<string, Vector>>;
    const vectors = [twist?.linear ?? wrench?.force, twist?.angular ?? wrench?.torque];
    this.#vectors = vectors.filter((each) => each !== undefined);
    this.update();
  }

  update(): void {
    const scale = Number(this.#context.settings.scale);
    for (const [at, { x, y, z }] of this.#vectors.entries()) {
      this.#lines[at]?.set(Float32Array.of(0, 0, 0, x * scale, y * scale, z * scale));
    }
  }

  draw(view: View): void {
    const model = this.#header && view.place(this.#header);
    if (model === undefined) return;
    const { color, turnColor } = this.#context.settings;
    for (const [at, vertices] of this.#lines.entries()) {
      const paint = parseColor(String(at === 0 ? color : turnColor));
      renderer.lines({ vertices, count: 2, width: 4, color: paint }, model);
    }
  }

  problems(places: Places): Problems {
    return this.#header === undefined ? NO_PROBLEMS : places.locate(this.#header);
  }

  facts(): string {
    return this.#vectors.map(({ x, y, z }) => Math.hypot(x, y, z).toFixed(2)).join(" and ");
  }

  close(): void {
    for (const vertices of this.#lines) vertices.close();
  }
}
