/**
 * Reads the geometries of Collada files: triangles, transforms, the unit, and diffuse colours.
 *
 * `<up_axis>` is ignored, as by RViz: robots are modelled with that in mind. Textures, skins and
 * animations are left out.
 */
import { greatest } from "../../../lists";
import type { Color } from "../colors";
import { type Matrix, product } from "../matrix";
import { MeshBuilder, type MeshData, type Point } from "./mesh";
import { readXml, type XmlElement } from "./xml";

/** Nodes that a scene may have, since they can be used again and again. */
const MAX_NODES = 100_000;
const MAX_DEPTH = 100;
const IDENTITY: Matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** The numbers of a source, `stride` of them for each index. */
interface Source {
  readonly numbers: Float64Array;
  readonly stride: number;
}

/** Read a file; throws an `Error` that says in which line what is wrong. */
export function readDae(text: string): MeshData {
  const root = readXml(text);
  if (root.name !== "COLLADA") throw root.fault(`expected <COLLADA>, got <${root.name}>`);
  return new Reader(root).read();
}

class Reader {
  readonly #root: XmlElement;
  readonly #ids = new Map<string, XmlElement>();
  readonly #sources = new Map<XmlElement, Source>();
  readonly #builder = new MeshBuilder();
  #nodes = 0;

  constructor(root: XmlElement) {
    this.#root = root;
    const all = [root];
    for (const element of all) {
      const id = element.get("id");
      if (id !== undefined) this.#ids.set(id, element);
      for (const child of element.children) all.push(child);
    }
  }

  read(): MeshData {
    const root = this.#root;
    const meter = Number(root.first("asset")?.first("unit")?.get("meter") ?? 1);
    const unit = meter > 0 && meter < Infinity ? meter : 1;
    const top = scaled(unit, unit, unit);
    const used = root.first("scene")?.first("instance_visual_scene");
    const scene = used && this.#find(used, "url");
    for (const node of scene?.all("node") ?? []) this.#addNode(node, top, 0);
    return this.#builder.data;
  }

  /** The element that an attribute names: `url="#name"`. */
  #find(element: XmlElement, attribute: string): XmlElement {
    const name = element.required(attribute);
    const found = this.#ids.get(name.replace(/^#/, ""));
    if (found === undefined) throw element.fault(`<${element.name}>: unknown ${name}`);
    return found;
  }

  #addNode(node: XmlElement, above: Matrix, depth: number): void {
    this.#nodes += 1;
    if (depth > MAX_DEPTH) throw node.fault("nodes are nested too deeply, or in a loop");
    if (this.#nodes > MAX_NODES) throw node.fault(`too many nodes (limit ${MAX_NODES})`);
    let matrix = above;
    for (const element of node.children) {
      const step = transformOf(element);
      if (step !== undefined) matrix = product(matrix, step);
    }
    for (const element of node.children) {
      switch (element.name) {
        case "node":
          this.#addNode(element, matrix, depth + 1);
          break;
        case "instance_node":
          this.#addNode(this.#find(element, "url"), matrix, depth + 1);
          break;
        case "instance_geometry":
          this.#addGeometry(this.#find(element, "url"), matrix, this.#materials(element));
          break;
        case "instance_controller": {
          const skin = this.#find(element, "url").first("skin");
          if (skin === undefined) break;
          this.#addGeometry(this.#find(skin, "source"), matrix, this.#materials(element));
          break;
        }
      }
    }
  }

  /** The colours of an instance, by the symbols of its materials. */
  #materials(instance: XmlElement): Map<string, Color> {
    const found = new Map<string, Color>();
    const bound = instance.first("bind_material")?.first("technique_common");
    for (const each of bound?.all("instance_material") ?? []) {
      const color = this.#colorOf(this.#ids.get((each.get("target") ?? "").replace(/^#/, "")));
      if (color !== undefined) found.set(each.get("symbol") ?? "", color);
    }
    return found;
  }

  #colorOf(material: XmlElement | undefined): Color | undefined {
    const effect = this.#ids.get((material?.first("instance_effect")?.get("url") ?? "").slice(1));
    const technique = effect?.first("profile_COMMON")?.first("technique");
    const [shading] = (technique?.children ?? []).filter(({ name }) =>
      ["phong", "lambert", "blinn", "constant"].includes(name),
    );
    const diffuse = shading?.first(shading.name === "constant" ? "emission" : "diffuse");
    const color = diffuse?.first("color");
    if (color === undefined) return undefined;
    const [red = 0, green = 0, blue = 0] = numbersOf(color);
    return [red, green, blue, 1];
  }

  #addGeometry(geometry: XmlElement, matrix: Matrix, colors: ReadonlyMap<string, Color>): void {
    const mesh = geometry.first("mesh");
    if (mesh === undefined) return;
    for (const element of mesh.children) {
      const indices = indicesOf(element);
      if (indices === undefined) continue;
      this.#addTriangles(element, indices, matrix, colors.get(element.get("material") ?? ""));
    }
  }

  /** Add polygons: each has a list of the corners' indices. */
  #addTriangles(
    element: XmlElement,
    polygons: readonly (readonly number[])[],
    matrix: Matrix,
    color: Color | undefined,
  ): void {
    const inputs = element.all("input");
    const step =
      1 +
      greatest(
        inputs.map((each) => Number(each.get("offset") ?? 0)),
        0,
      );
    const input = (semantic: string, among: readonly XmlElement[]): XmlElement | undefined =>
      among.find((each) => each.get("semantic") === semantic);
    const vertex = input("VERTEX", inputs);
    if (vertex === undefined) throw element.fault(`<${element.name}> has no input VERTEX`);
    const shared = this.#find(vertex, "source").all("input");
    const position = input("POSITION", shared);
    if (position === undefined) throw vertex.fault("<vertices> has no input POSITION");
    const places = this.#source(position);
    const ownNormals = input("NORMAL", inputs);
    const normal = ownNormals ?? input("NORMAL", shared);
    const normals = normal && this.#source(normal);
    const placeAt = Number(vertex.get("offset") ?? 0);
    const normalAt = Number((ownNormals ?? vertex).get("offset") ?? 0);
    const turn = normalMatrix(matrix);
    const isMirrored = mirrors(matrix);
    for (const flat of polygons) {
      const count = Math.floor(flat.length / step);
      const place = (corner: number): Point =>
        moved(matrix, pick(places, flat[corner * step + placeAt] as number, element));
      const direction = (corner: number): Point =>
        turned(turn, pick(normals as Source, flat[corner * step + normalAt] as number, element));
      for (let at = 2; at < count; at += 1) {
        const corners = isMirrored ? [0, at, at - 1] : [0, at - 1, at];
        const three = corners.map(place) as [Point, Point, Point];
        const own = normals && (corners.map(direction) as [Point, Point, Point]);
        this.#builder.add(...three, color, own);
      }
    }
  }

  #source(input: XmlElement): Source {
    const element = this.#find(input, "source");
    let known = this.#sources.get(element);
    if (known === undefined) {
      const array = element.first("float_array");
      if (array === undefined) throw element.fault("<source> has no <float_array>");
      const accessor = element.first("technique_common")?.first("accessor");
      const stride = Number(accessor?.get("stride") ?? 3);
      if (!(stride >= 3)) throw element.fault(`expected a stride of 3 or more, got ${stride}`);
      known = { numbers: Float64Array.from(numbersOf(array)), stride };
      this.#sources.set(element, known);
    }
    return known;
  }
}

/** The polygons of an element, each as a list of numbers; `undefined` if it has none. */
function indicesOf(element: XmlElement): number[][] | undefined {
  const all = element.all("p").map(numbersOf);
  const inputs = element.all("input");
  const step =
    1 +
    greatest(
      inputs.map((each) => Number(each.get("offset") ?? 0)),
      0,
    );
  switch (element.name) {
    case "triangles":
      return all.flatMap((each) => pieces(each, () => 3 * step));
    case "polylist": {
      const counts = element.first("vcount");
      const sizes = counts === undefined ? [] : numbersOf(counts);
      return all.flatMap((each) => pieces(each, (index) => (sizes[index] ?? 0) * step));
    }
    case "polygons":
    case "trifans":
      return all;
    case "tristrips":
      return all.flatMap((each) => {
        const found: number[][] = [];
        for (let at = 0; at + 3 * step <= each.length; at += step) {
          const [a, b, c] = [0, 1, 2].map((corner) =>
            each.slice(at + corner * step, at + (corner + 1) * step),
          ) as [number[], number[], number[]];
          found.push((at / step) % 2 === 0 ? [...a, ...b, ...c] : [...b, ...a, ...c]);
        }
        return found;
      });
    default:
      return undefined;
  }
}

/** Cut a list into pieces of given lengths. */
function pieces(numbers: readonly number[], size: (index: number) => number): number[][] {
  const found: number[][] = [];
  for (let at = 0; at < numbers.length; ) {
    const length = size(found.length);
    if (!(length > 0)) break;
    found.push(numbers.slice(at, at + length));
    at += length;
  }
  return found;
}

/** The numbers in an element's text. */
function numbersOf(element: XmlElement): number[] {
  const text = element.text.trim();
  if (text === "") return [];
  const found = text.split(/\s+/).map(Number);
  const wrong = found.findIndex(Number.isNaN);
  if (wrong >= 0) throw element.fault(`<${element.name}>: number ${wrong + 1} is invalid`);
  return found;
}

function pick({ numbers, stride }: Source, index: number, element: XmlElement): Point {
  const at = index * stride;
  const [x, y, z] = [numbers[at], numbers[at + 1], numbers[at + 2]];
  if (x === undefined || y === undefined || z === undefined) {
    const count = numbers.length / stride;
    throw element.fault(`<${element.name}>: no point ${index}, there are ${count}`);
  }
  return [x, y, z];
}

function transformOf(element: XmlElement): Matrix | undefined {
  const numbers = (count: number): number[] => {
    const found = numbersOf(element);
    if (found.length !== count) {
      throw element.fault(`expected ${count} numbers in <${element.name}>, got ${found.length}`);
    }
    return found;
  };
  switch (element.name) {
    case "matrix": {
      // Row by row, unlike ours.
      const m = numbers(16);
      return m.map((_, at) => m[(at % 4) * 4 + (at >> 2)] as number);
    }
    case "translate":
      return [...IDENTITY.slice(0, 12), ...numbers(3), 1];
    case "scale": {
      const [x = 1, y = 1, z = 1] = numbers(3);
      return scaled(x, y, z);
    }
    case "rotate": {
      const [x = 0, y = 0, z = 0, degrees = 0] = numbers(4);
      return rotation(x, y, z, (degrees * Math.PI) / 180);
    }
    default:
      return undefined;
  }
}

function scaled(x: number, y: number, z: number): Matrix {
  return [x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1];
}

function rotation(a: number, b: number, c: number, angle: number): Matrix {
  const length = Math.hypot(a, b, c) || 1;
  const [x, y, z] = [a / length, b / length, c / length];
  const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
  const k = 1 - cosine;
  return [
    ...[k * x * x + cosine, k * x * y + sine * z, k * x * z - sine * y, 0],
    ...[k * x * y - sine * z, k * y * y + cosine, k * y * z + sine * x, 0],
    ...[k * x * z + sine * y, k * y * z - sine * x, k * z * z + cosine, 0],
    ...[0, 0, 0, 1],
  ];
}

function moved(m: Matrix, [x, y, z]: Point): Point {
  const row = (at: number): number =>
    (m[at] as number) * x +
    (m[at + 4] as number) * y +
    (m[at + 8] as number) * z +
    (m[at + 12] as number);
  return [row(0), row(1), row(2)];
}

/** The matrix for normals: the cofactors, which keep them upright on surfaces that are stretched. */
function normalMatrix(m: Matrix): readonly Point[] {
  const [a, b, c] = [0, 4, 8].map((at) => m.slice(at, at + 3)) as unknown as [Point, Point, Point];
  const found = [cross(b, c), cross(c, a), cross(a, b)];
  return mirrors(m) ? found.map(([x, y, z]) => [-x, -y, -z]) : found;
}

/** Whether a matrix makes a left hand of a right one. */
function mirrors(m: Matrix): boolean {
  const [a, b, c] = [0, 4, 8].map((at) => m.slice(at, at + 3)) as unknown as [Point, Point, Point];
  const [x, y, z] = cross(b, c);
  return a[0] * x + a[1] * y + a[2] * z < 0;
}

function cross(u: Point, v: Point): Point {
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}

function turned([a, b, c]: readonly Point[], [x, y, z]: Point): Point {
  const row = (at: 0 | 1 | 2): number =>
    (a as Point)[at] * x + (b as Point)[at] * y + (c as Point)[at] * z;
  const found: Point = [row(0), row(1), row(2)];
  const length = Math.hypot(...found);
  return length > 0 ? [found[0] / length, found[1] / length, found[2] / length] : [0, 0, 1];
}
