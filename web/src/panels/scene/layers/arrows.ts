/** Arrows and axes that stand for poses: arrows point along x. */
import { applied, type Transform, unit, type Vector } from "../../../transforms";
import type { Color } from "../colors";
import type { Pose } from "../message";
import { renderer, Vertices } from "../renderer";

/** The thickness of an arrow, for a length of 1. */
const THICK = 0.14;

export class Arrows {
  readonly #vertices = new Vertices();
  #count = 0;
  #isClear = false;

  set(poses: readonly Pose[], length: number, color: Color): void {
    const numbers = new Float32Array(poses.length * 14);
    const thick = length * THICK;
    for (const [at, { position, orientation }] of poses.entries()) {
      const { rotation } = unit({ translation: position, rotation: orientation });
      const { x, y, z } = position;
      const turn = [rotation.x, rotation.y, rotation.z, rotation.w];
      numbers.set([x, y, z, ...turn, length, thick, thick, ...color], at * 14);
    }
    this.#vertices.set(numbers);
    this.#count = poses.length;
    this.#isClear = color[3] < 1;
  }

  draw(model: Transform): void {
    const [vertices, count, isClear] = [this.#vertices, this.#count, this.#isClear];
    renderer.solids({ shape: "arrow", vertices, count, isClear }, model);
  }

  close(): void {
    this.#vertices.close();
  }
}

/** Bytes of a point of a line with a colour. */
const POINT = 16;
/** Of x, y and z: red, green, blue and alpha, the last one first. */
const COLORS = [0xff3b3be5, 0xff4aa046, 0xffe5733b];

/** The axes of poses: x is red, y green, z blue. */
export class Axes {
  readonly #vertices = new Vertices();
  #count = 0;

  set(poses: readonly Pose[], length: number): void {
    this.setTransforms(
      poses.map(({ position, orientation }) =>
        unit({ translation: position, rotation: orientation }),
      ),
      length,
    );
  }

  setTransforms(places: readonly Transform[], length: number): void {
    const lines = new DataView(new ArrayBuffer(places.length * 6 * POINT));
    let at = 0;
    const point = ({ x, y, z }: Vector, color: number): void => {
      lines.setFloat32(at, x, true);
      lines.setFloat32(at + 4, y, true);
      lines.setFloat32(at + 8, z, true);
      lines.setUint32(at + 12, color, true);
      at += POINT;
    };
    for (const place of places) {
      for (const [axis, color] of COLORS.entries()) {
        const [x, y, z] = [0, 1, 2].map((each) => (each === axis ? length : 0));
        point(place.translation, color);
        point(applied(place, { x, y, z } as Vector), color);
      }
    }
    this.#vertices.set(lines);
    this.#count = places.length * 6;
  }

  draw(model?: Transform): void {
    renderer.lines({ vertices: this.#vertices, count: this.#count, pairs: true, width: 2 }, model);
  }

  close(): void {
    this.#vertices.close();
  }
}
