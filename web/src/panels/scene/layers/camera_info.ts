/** What a camera sees: sensor_msgs/CameraInfo as a pyramid, in its optical frame. */
import type { Fields } from "../../../messages/reader";
import { floats } from "../../../messages/values";
import { applied, type Vector } from "../../../transforms";
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

export class CameraInfo implements Layer {
  readonly #context: LayerContext;
  readonly #vertices = new Vertices();
  #message: Fields | undefined;
  #corners: readonly Vector[] = [];
  #facts = "";

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields): void {
    this.#message = message;
    this.update();
  }

  update(): void {
    if (this.#message === undefined) return;
    const { width, height } = this.#message as Record<string, number>;
    this.#corners = frustum(this.#message, Number(this.#context.settings.depth));
    const points = this.#corners.flatMap((corner, at) => {
      const next = this.#corners[(at + 1) % 4] as Vector;
      return [{ x: 0, y: 0, z: 0 }, corner, corner, next];
    });
    // A mark on the upper edge.
    const [a, b] = this.#corners as [Vector, Vector];
    const top = { x: (a.x + b.x) / 2, y: a.y * 1.25, z: a.z };
    points.push(a, top, top, b);
    this.#vertices.set(Float32Array.from(points.flatMap(({ x, y, z }) => [x, y, z])));
    const degrees = (2 * Math.atan((b.x - a.x) / 2 / (a.z || 1)) * 180) / Math.PI;
    this.#facts = `${width} × ${height}, ${degrees.toFixed(0)}° wide`;
  }

  draw(view: View): void {
    const model = this.#message && view.place(this.#message.header as Header);
    if (model === undefined) return;
    const count = this.#vertices.data.byteLength / 12;
    const color = parseColor(String(this.#context.settings.color));
    renderer.lines({ vertices: this.#vertices, count, pairs: true, width: 2, color }, model);
  }

  problems(places: Places): Problems {
    const header = this.#message?.header as Header | undefined;
    return header === undefined ? NO_PROBLEMS : places.locate(header);
  }

  facts(): string {
    return this.#facts;
  }

  extent(view: View): Vector[] {
    const model = this.#message && view.place(this.#message.header as Header);
    return model === undefined ? [] : this.#corners.map((each) => applied(model, each));
  }

  close(): void {
    this.#vertices.close();
  }
}

/**
 * The corners of the picture at a depth, from the upper left one on, clockwise.
 *
 * Throws an `Error` if the camera is not calibrated.
 */
export function frustum(message: Fields, depth: number): Vector[] {
  const { width = 0, height = 0 } = message as Record<string, number>;
  const [fx = 0, , cx = 0, , fy = 0, cy = 0] = floats(message.K ?? message.k);
  if (!(fx > 0 && fy > 0)) throw new Error("the camera is not calibrated: K is 0");
  return [
    [0, 0],
    [width, 0],
    [width, height],
    [0, height],
  ].map(([u = 0, v = 0]) => ({
    x: ((u - cx) / fx) * depth,
    y: ((v - cy) / fy) * depth,
    z: depth,
  }));
}
