/** The coordinate frames of tf: their axes, their names, and lines to their parents. */
import { applied, type Vector } from "../../../transforms";
import type { Layer, LayerContext, LayerKind, View } from "../layer";
import { renderer, Vertices } from "../renderer";

/** Bytes of a point of a line with a colour. */
const POINT = 16;
const COLORS = [0xff3b3be5, 0xff4aa046, 0xffe5733b];

export const FRAMES: LayerKind = {
  label: "Frames (tf)",
  types: ["tf2_msgs/TFMessage", "tf/tfMessage"],
  throttle: 0,
  isOwn: true,
  isFirst: true,
  settings: [
    { name: "names", label: "Names", value: true },
    { name: "lines", label: "Lines to parents", value: true },
    { name: "size", label: "Axes (m)", value: 0.3, min: 0.01, max: 10, step: 0.05 },
    { name: "below", label: "Only below", value: "" },
  ],
  accepts: (topic) => topic === "/tf",
  make: (context) => new Frames(context),
};

class Frames implements Layer {
  readonly #context: LayerContext;
  readonly #axes = new Vertices();
  readonly #parents = new Vertices();

  constructor(context: LayerContext) {
    this.#context = context;
  }

  /** The frames to draw, each with its place in the fixed frame. */
  #places(view: View): Map<string, NonNullable<ReturnType<View["placeNow"]>>> {
    const { transforms, settings } = this.#context;
    const below = String(settings.below);
    const found = new Map<string, NonNullable<ReturnType<View["placeNow"]>>>();
    for (const name of transforms.names) {
      if (below !== "" && !this.#isBelow(name, below)) continue;
      // Frames of another tree are not wrong: their own layers report them.
      const place = view.placeIfKnown(name);
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
    const size = Number(settings.size);
    const axes = new DataView(new ArrayBuffer(places.size * 6 * POINT));
    let at = 0;
    const point = (to: DataView, { x, y, z }: Vector, color: number): void => {
      for (const [number, value] of [x, y, z].entries())
        to.setFloat32(at + 4 * number, value, true);
      to.setUint32(at + 12, color, true);
      at += POINT;
    };
    const parents: [Vector, Vector][] = [];
    for (const [name, place] of places) {
      for (const [axis, color] of COLORS.entries()) {
        const end = {
          x: axis === 0 ? size : 0,
          y: axis === 1 ? size : 0,
          z: axis === 2 ? size : 0,
        };
        point(axes, place.translation, color);
        point(axes, applied(place, end), color);
      }
      const parent = transforms.parentOf(name);
      const above = parent === undefined ? undefined : places.get(parent);
      if (above !== undefined) parents.push([place.translation, above.translation]);
      if (settings.names === true) view.label(name, place.translation);
    }
    this.#axes.set(axes);
    renderer.lines({ vertices: this.#axes, count: places.size * 6, pairs: true, width: 2 });
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

  facts(): string {
    const { length } = this.#context.transforms.names;
    return length === 1 ? "1 frame" : `${length} frames`;
  }

  extent(view: View): Vector[] {
    return [...this.#places(view).values()].map(({ translation }) => translation);
  }

  close(): void {
    this.#axes.close();
    this.#parents.close();
  }
}
