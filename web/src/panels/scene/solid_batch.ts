/** Solids that move each on its own, drawn together: one call for all of a shape. */
import { append } from "../../lists";
import { IDENTITY, multiplied, type Transform, type Vector } from "../../transforms";
import type { Color } from "./colors";
import { renderer, Vertices } from "./renderer";
import type { Shape } from "./shapes";

export interface Solid {
  readonly shape: Shape;
  readonly origin: Transform;
  readonly size: Vector;
  readonly color: Color;
}

interface Group {
  readonly shape: Shape;
  readonly isClear: boolean;
  readonly vertices: Vertices;
  numbers: number[];
}

export class SolidBatch {
  readonly #groups = new Map<string, Group>();
  /** A place near all of them: far from the origin, float32 is too coarse. */
  #anchor: Vector | undefined;

  /** Forget the solids of the last picture. */
  begin(): void {
    this.#anchor = undefined;
    for (const group of this.#groups.values()) group.numbers = [];
  }

  /** Add a solid whose `origin` is in `model`. */
  add({ shape, origin, size, color }: Solid, model: Transform): void {
    const isClear = color[3] < 1;
    const key = `${shape} ${isClear}`;
    let group = this.#groups.get(key);
    if (group === undefined) {
      group = { shape, isClear, vertices: new Vertices(), numbers: [] };
      this.#groups.set(key, group);
    }
    const { translation, rotation } = multiplied(model, origin);
    this.#anchor ??= translation;
    const { x, y, z } = this.#anchor;
    const { x: qx, y: qy, z: qz, w } = rotation;
    const place = [translation.x - x, translation.y - y, translation.z - z];
    append(group.numbers, [...place, qx, qy, qz, w, size.x, size.y, size.z, ...color]);
  }

  draw(): void {
    const model = { ...IDENTITY, translation: this.#anchor ?? IDENTITY.translation };
    for (const { shape, isClear, vertices, numbers } of this.#groups.values()) {
      if (numbers.length === 0) continue;
      vertices.set(Float32Array.from(numbers));
      renderer.solids({ shape, vertices, count: numbers.length / 14, isClear }, model);
    }
  }

  close(): void {
    for (const { vertices } of this.#groups.values()) vertices.close();
  }
}
