/** The coordinate frames of tf: their axes, their names, and lines to their parents. */
import { IDENTITY, type Transform, type Vector } from "../../../transforms";
import {
  type Hit,
  type Layer,
  type LayerContext,
  NO_PROBLEMS,
  type Pointer,
  type Problems,
  type View,
} from "../layer";
import { nearestPoint } from "../picking";
import { renderer, Vertices } from "../renderer";
import { Axes } from "./arrows";

export class Frames implements Layer {
  readonly #context: LayerContext;
  readonly #axes = new Axes();
  readonly #parents = new Vertices();

  constructor(context: LayerContext) {
    this.#context = context;
  }

  /** The frames to draw, each with its place in the fixed frame. */
  #places(view: View): Map<string, Transform> {
    const { transforms, settings } = this.#context;
    const below = String(settings.below);
    const found = new Map<string, Transform>();
    for (const name of transforms.names) {
      if (below !== "" && !this.#isBelow(name, below)) continue;
      const place = view.placeNow(name);
      if (place !== undefined) found.set(name, place);
    }
    return found;
  }

  #isBelow(name: string, ancestor: string): boolean {
    const path = new Set<string>();
    for (let at: string | undefined = name; at !== undefined && !path.has(at); ) {
      if (at === ancestor) return true;
      path.add(at);
      at = this.#context.transforms.parentOf(at);
    }
    return false;
  }

  draw(view: View): void {
    const { settings, transforms } = this.#context;
    const places = this.#places(view);
    const parents: [Vector, Vector][] = [];
    for (const [name, place] of places) {
      const parent = transforms.parentOf(name);
      const above = parent === undefined ? undefined : places.get(parent);
      if (above !== undefined) parents.push([place.translation, above.translation]);
      if (settings.names === true) view.label(name, place.translation);
    }
    this.#axes.setTransforms([...places.values()], Number(settings.size));
    this.#axes.draw();
    if (settings.lines !== true) return;
    const flat = parents.flatMap((pair) => pair.flatMap(({ x, y, z }) => [x, y, z]));
    this.#parents.set(Float32Array.from(flat));
    const color = view.theme.soft;
    renderer.lines({
      vertices: this.#parents,
      count: parents.length * 2,
      pairs: true,
      width: 1,
      color,
    });
  }

  problems(): Problems {
    // Frames of another tree are not wrong: the layers that need them report them.
    return NO_PROBLEMS;
  }

  facts(): string {
    const { length } = this.#context.transforms.names;
    return length === 1 ? "1 frame" : `${length} frames`;
  }

  pick(view: View, pointer: Pointer): Hit | undefined {
    const places = [...this.#places(view)];
    const numbers = places.flatMap(
      ([
        ,
        {
          translation: { x, y, z },
        },
      ]) => [x, y, z],
    );
    const near = nearestPoint(view, pointer, IDENTITY, numbers, 3);
    return near && { ...near, text: places[near.index]?.[0] ?? "" };
  }

  extent(view: View): Vector[] {
    return [...this.#places(view).values()].map(({ translation }) => translation);
  }

  close(): void {
    this.#axes.close();
    this.#parents.close();
  }
}
