/** Paths, polygons and cells of grids: nav_msgs/Path, geometry_msgs/PolygonStamped, nav_msgs/GridCells. */

import { plural } from "../../../format";
import { append } from "../../../lists";
import type { Fields } from "../../../messages/reader";
import type { Vector } from "../../../transforms";
import { parseColor } from "../colors";
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
import { corners, nearestPoint } from "../picking";
import { renderer, Vertices } from "../renderer";
import { Arrows } from "./arrows";

/** One line through the poses of a path, or the edge of a polygon. */
export class Lines implements Layer {
  readonly #context: LayerContext;
  readonly #vertices = new Vertices();
  readonly #arrows = new Arrows();
  #header: Header | undefined;
  #numbers = new Float32Array();
  #poses: readonly Pose[] = [];
  #facts = "";

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields): void {
    this.#header = message.header as Header;
    const { polygon } = message as { polygon?: { points: Vector[] } };
    const path = (message.poses ?? []) as { pose: Pose }[];
    this.#poses = path.map(({ pose }) => pose);
    const points = polygon?.points ?? this.#poses.map(({ position }) => position);
    const numbers = points.flatMap(({ x, y, z }) => [x, y, z]);
    this.#facts =
      polygon === undefined
        ? `${plural(points.length, "pose")}, ${length(points).toFixed(1)} m`
        : plural(points.length, "corner");
    // A polygon ends where it begins.
    if (polygon !== undefined) append(numbers, numbers.slice(0, 3));
    this.#numbers = Float32Array.from(numbers);
    this.#vertices.set(this.#numbers);
    this.update();
  }

  update(): void {
    const { arrows, color } = this.#context.settings;
    const poses = arrows === true ? this.#poses : [];
    this.#arrows.set(poses, 0.2, parseColor(String(color)));
  }

  draw(view: View): void {
    const model = this.#header && view.place(this.#header);
    if (model === undefined) return;
    const { settings } = this.#context;
    renderer.lines(
      {
        vertices: this.#vertices,
        count: this.#numbers.length / 3,
        width: Number(settings.width),
        color: parseColor(String(settings.color)),
      },
      model,
    );
    this.#arrows.draw(model);
  }

  problems(places: Places): Problems {
    return this.#header === undefined ? NO_PROBLEMS : places.locate(this.#header);
  }

  facts(): string {
    return this.#facts;
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const model = this.#header && view.place(this.#header);
    const near = model && nearestPoint(view, pointer, model, this.#numbers, 3);
    const what = this.#poses.length > 0 ? "pose" : "corner";
    return near && { ...near, text: `${what} ${near.index}` };
  }

  extent(view: View): Vector[] {
    const model = this.#header && view.place(this.#header);
    return model === undefined ? [] : corners(this.#numbers, 3, model);
  }

  close(): void {
    this.#vertices.close();
    this.#arrows.close();
  }
}

function length(points: readonly Vector[]): number {
  return points.slice(1).reduce((sum, { x, y, z }, at) => {
    const before = points[at] as Vector;
    return sum + Math.hypot(x - before.x, y - before.y, z - before.z);
  }, 0);
}

export class GridCells implements Layer {
  readonly #context: LayerContext;
  readonly #vertices = new Vertices();
  #message: Fields | undefined;
  #numbers = new Float32Array();

  constructor(context: LayerContext) {
    this.#context = context;
  }

  get #cells(): readonly Vector[] {
    return (this.#message?.cells ?? []) as Vector[];
  }

  receive(message: Fields): void {
    this.#message = message;
    this.#numbers = Float32Array.from(this.#cells.flatMap(({ x, y, z }) => [x, y, z]));
    this.update();
  }

  update(): void {
    const { color, alpha } = this.#context.settings;
    const { cell_width = 0, cell_height = 0 } = (this.#message ?? {}) as Record<string, number>;
    const paint = parseColor(String(color), Number(alpha));
    this.#vertices.set(
      Float32Array.from(
        this.#cells.flatMap(({ x, y, z }) => [
          ...[x, y, z, 0, 0, 0, 1, cell_width, cell_height, 0.001],
          ...paint,
        ]),
      ),
    );
  }

  draw(view: View): void {
    const model = this.#message && view.place(this.#message.header as Header);
    if (model === undefined) return;
    const isClear = Number(this.#context.settings.alpha) < 1;
    const count = this.#cells.length;
    renderer.solids({ shape: "box", vertices: this.#vertices, count, isClear }, model);
  }

  problems(places: Places): Problems {
    const header = this.#message?.header as Header | undefined;
    return header === undefined ? NO_PROBLEMS : places.locate(header);
  }

  facts(): string {
    return plural(this.#cells.length, "cell");
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const model = this.#message && view.place(this.#message.header as Header);
    const near = model && nearestPoint(view, pointer, model, this.#numbers, 3);
    return near && { ...near, text: `cell ${near.index}` };
  }

  extent(view: View): Vector[] {
    const model = this.#message && view.place(this.#message.header as Header);
    return model === undefined ? [] : corners(this.#numbers, 3, model);
  }

  close(): void {
    this.#vertices.close();
  }
}
