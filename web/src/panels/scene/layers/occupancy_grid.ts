/** Maps: nav_msgs/OccupancyGrid, and the map_msgs/OccupancyGridUpdate that change parts of them. */
import type { Fields } from "../../../messages/reader";
import { checkGrid } from "../../../messages/sizes";
import { bytes } from "../../../messages/values";
import {
  applied,
  inverse,
  multiplied,
  type Transform,
  unit,
  type Vector,
} from "../../../transforms";
import type { Palette } from "../colors";
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
import { Cells, renderer } from "../renderer";

const UNKNOWN = 255;

interface Info {
  readonly width: number;
  readonly height: number;
  /** The edge of a cell, in m. */
  readonly resolution: number;
  readonly origin: { readonly position: Vector; readonly orientation: Transform["rotation"] };
}

export class OccupancyGrid implements Layer {
  readonly #context: LayerContext;
  readonly #cells = new Cells();
  #header: Header | undefined;
  #origin: Transform | undefined;
  #resolution = 0;

  constructor(context: LayerContext) {
    this.#context = context;
  }

  receive(message: Fields): void {
    const { width, height, resolution, origin } = message.info as Info;
    const data = bytes(message.data);
    // A map without cells is one that is not known yet.
    if (width * height !== 0) checkGrid(width, height, data.length);
    if (!(resolution > 0)) throw new Error(`the resolution must be above 0, got ${resolution}`);
    this.#header = message.header as Header;
    this.#origin = unit({ translation: origin.position, rotation: origin.orientation });
    this.#resolution = resolution;
    this.#cells.set(width, height, data);
  }

  receiveUpdate(message: Fields): void {
    const { x = 0, y = 0, width = 0, height = 0 } = message as Record<string, number>;
    const cells = this.#cells;
    const data = bytes(message.data);
    // Updates may come before the map.
    if (this.#header === undefined) return;
    if (x < 0 || y < 0 || x + width > cells.width || y + height > cells.height) {
      throw new Error(
        `an update of ${width} × ${height} cells at ${x}, ${y} is outside of the map`,
      );
    }
    if (data.length < width * height) {
      throw new Error(`an update has ${data.length} cells, but ${width} × ${height} are expected`);
    }
    for (let row = 0; row < height; row += 1) {
      const part = data.subarray(row * width, (row + 1) * width);
      cells.data.set(part, (y + row) * cells.width + x);
    }
    cells.touch(y, y + height);
  }

  /** Where the lower left corner is; a map is drawn where its frame is now. */
  #place(view: View): Transform | undefined {
    const frame = this.#header && view.placeNow(this.#header.frame_id);
    return frame && this.#origin && multiplied(frame, this.#origin);
  }

  draw(view: View): void {
    const place = this.#place(view);
    if (place === undefined) return;
    const { palette, alpha } = this.#context.settings;
    renderer.grid(
      {
        cells: this.#cells,
        resolution: this.#resolution,
        palette: palette as Palette,
        alpha: Number(alpha),
      },
      place,
    );
  }

  problems(places: Places): Problems {
    return this.#header === undefined ? NO_PROBLEMS : places.locateNow(this.#header.frame_id);
  }

  facts(): string {
    const { width, height } = this.#cells;
    return width === 0 ? "no cells" : `${width} × ${height} cells of ${figure(this.#resolution)} m`;
  }

  pick(view: View, { x, y }: Pointer): Hit | undefined {
    const place = this.#place(view);
    if (place === undefined) return undefined;
    const ground = view.camera.ground(x, y, place.translation.z);
    if (ground === undefined) return undefined;
    const inside = applied(inverse(place), ground);
    const [column, row] = [inside.x, inside.y].map((each) => Math.floor(each / this.#resolution));
    const { width, height, data } = this.#cells;
    if (column === undefined || row === undefined) return undefined;
    if (column < 0 || row < 0 || column >= width || row >= height) return undefined;
    const value = data[row * width + column] as number;
    const meaning = value === 0 ? " (free)" : value === 100 ? " (occupied)" : "";
    const text = value === UNKNOWN ? "unknown" : `${(value << 24) >> 24}${meaning}`;
    // Whatever lies on the map is nearer.
    return { distance: Infinity, text: `cell ${column}, ${row}: ${text}`, place: ground };
  }

  extent(view: View): Vector[] {
    const place = this.#place(view);
    if (place === undefined) return [];
    const { width, height } = this.#cells;
    return [0, 1, 2, 3].map((corner) =>
      applied(place, {
        x: (corner & 1) * width * this.#resolution,
        y: (corner >> 1) * height * this.#resolution,
        z: 0,
      }),
    );
  }

  close(): void {
    this.#cells.close();
  }
}

function figure(value: number): number {
  return Number(value.toPrecision(4));
}
