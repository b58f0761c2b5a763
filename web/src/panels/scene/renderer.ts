/**
 * Draws with WebGL: points, lines, cells of maps, solids and meshes.
 *
 * There is one context for the page, since browsers allow few: each picture is drawn with it and
 * copied. Buffers keep their data, from which they are made again when the context is lost.
 */
import { IDENTITY, type Transform, type Vector } from "../../transforms";
import type { Camera } from "./camera";
import { type Color, PALETTES, type Palette, paletteBytes } from "./colors";
import { type Matrix, matrixOf, product } from "./matrix";
import { SHADERS } from "./shaders";
import { type Shape, shapeTriangles } from "./shapes";

/** The most pixels of the screen for one of CSS. */
const MAX_RATIO = 2;
/** Points of a cloud that are drawn at most, with a graphics card and without. */
const POINTS = 1_000_000;
const SOFTWARE_POINTS = 100_000;
/** What has not been drawn for this time is freed, in ms: its panel may have been closed. */
const UNUSED = 60_000;
/** While the camera moves: every this many points, of clouds that have more than these. */
const [HASTY, HASTY_POINTS] = [3, 20_000];
/** Bytes from one vertex to the next that WebGL allows. */
const MAX_STRIDE = 255;
/** Bytes of an instance of a solid: see `Solids`. */
const INSTANCE = 56;

/** Data for WebGL, which is uploaded when it is next drawn. */
export class Vertices {
  #data: ArrayBufferView;
  /** How often the data has changed. */
  version = 0;

  constructor(data: ArrayBufferView = new Uint8Array()) {
    this.#data = data;
  }

  get data(): ArrayBufferView {
    return this.#data;
  }

  set(data: ArrayBufferView): void {
    this.#data = data;
    this.version += 1;
  }

  /** Free the memory of the graphics card. */
  close(): void {
    renderer.forget(this);
  }
}

/** The cells of a map, one byte each, row by row. */
export class Cells {
  width = 0;
  height = 0;
  data: Uint8Array = new Uint8Array();
  /** The rows that are not uploaded yet. */
  changed: readonly [from: number, to: number] = [0, 0];

  set(width: number, height: number, data: Uint8Array): void {
    Object.assign(this, { width, height, data, changed: [0, height] });
  }

  /** The data of some rows has changed. */
  touch(from: number, to: number): void {
    const [first, last] = this.changed;
    this.changed = first === last ? [from, to] : [Math.min(first, from), Math.max(last, to)];
  }

  close(): void {
    renderer.forget(this);
  }
}

/** Where the colours of points come from. */
export type Paint =
  | { readonly kind: "flat"; readonly color: Color }
  /** Bytes at an offset: blue, green, red. */
  | { readonly kind: "bgr"; readonly offset: number }
  /** A number at an offset, by a palette from `low` to `high`. */
  | ({ readonly kind: "number"; readonly offset: number; readonly type: NumberType } & Range)
  /** How far a point is along a direction in the frame of the points. */
  | ({ readonly kind: "along"; readonly axis: Vector; readonly from: number } & Range);

interface Range {
  readonly palette: Palette;
  readonly low: number;
  readonly high: number;
}

export type NumberType = "int8" | "uint8" | "int16" | "uint16" | "int32" | "uint32" | "float32";

/** Points, of which each begins with x, y and z as float32 at `offset`. */
export interface Points {
  readonly vertices: Vertices;
  readonly count: number;
  /** Bytes from one point to the next, and before the x of the first. Multiples of 4. */
  readonly stride: number;
  readonly offset?: number;
  /** The edge of a point, in CSS pixels. */
  readonly size: number;
  /** Whether `size` is in m. */
  readonly isMetric?: boolean;
  readonly paint: Paint;
  /** Draw only every this many of them. */
  readonly every?: number;
  readonly alpha?: number;
}

/** Lines through points, each of which is x, y and z as float32, and perhaps 4 bytes of colour. */
export interface Lines {
  readonly vertices: Vertices;
  /** The number of points. */
  readonly count: number;
  /** Whether each two points are a line; else all are one. */
  readonly pairs?: boolean;
  /** In CSS pixels. */
  readonly width: number;
  /** Whether `width` is in m. */
  readonly isMetric?: boolean;
  /** Whether maps lie above them. */
  readonly isGround?: boolean;
  /** The colour of all; without one, each point has its own: red, green, blue, alpha. */
  readonly color?: Color;
}

/**
 * Solids of one shape. Each is 14 numbers as float32: the place x y z, the rotation x y z w, the
 * size x y z, and the colour r g b a.
 */
export interface Solids {
  readonly shape: Shape;
  readonly vertices: Vertices;
  readonly count: number;
  /** Whether one can see through some of them. */
  readonly isClear?: boolean;
}

/** Triangles, each corner of which is x, y, z and the normal as float32. */
export interface Mesh {
  readonly vertices: Vertices;
  /** The number of corners. */
  readonly count: number;
  readonly color: Color;
  /** Whether 4 bytes of colour follow each normal; they are multiplied with `color`. */
  readonly hasColors?: boolean;
  readonly scale?: Vector;
  /** Without light, a triangle has its colour from all sides. */
  readonly isFlat?: boolean;
}

/** A map, whose lower left corner is at the origin. */
export interface Grid {
  readonly cells: Cells;
  /** The edge of a cell, in m. */
  readonly resolution: number;
  readonly palette: Palette;
  readonly alpha: number;
}

interface Program {
  readonly program: WebGLProgram;
  readonly uniforms: Map<string, WebGLUniformLocation>;
}

interface Attribute {
  readonly at: number;
  readonly size: number;
  readonly type?: number;
  readonly normalized?: boolean;
  readonly stride: number;
  readonly offset: number;
}

interface Tile {
  readonly texture: WebGLTexture;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** What has been made for the data of vertices, and when it was last drawn. */
interface Uploaded {
  readonly buffer: WebGLBuffer;
  version: number;
  size: number;
  used: number;
}

interface Tiles {
  readonly width: number;
  readonly height: number;
  readonly tiles: readonly Tile[];
  used: number;
}

/** Things are drawn in this order: maps never hide what lies on them. */
const [GROUND, SOLID, CLEAR] = [0, 1, 2];

interface Command {
  readonly order: number;
  run(gl: WebGL2RenderingContext): void;
}

const TYPES: Readonly<Record<NumberType, number>> = {
  int8: 0x1400,
  uint8: 0x1401,
  int16: 0x1402,
  uint16: 0x1403,
  int32: 0x1404,
  uint32: 0x1405,
  float32: 0x1406,
};

class Renderer {
  /** Why nothing can be drawn; empty while it can. */
  fault = "";
  /** Whether the processor draws: the picture is simpler then. */
  isSoftware = false;
  /** Whether clouds are thinner now: without a graphics card, while the camera moves. */
  isHasty = false;
  #canvas: OffscreenCanvas | undefined;
  #gl: WebGL2RenderingContext | null = null;
  #programs = new Map<string, Program>();
  #buffers = new Map<Vertices, Uploaded>();
  #tiles = new Map<Cells, Tiles>();
  readonly #shapes = new Map<Shape, Vertices>();
  #palettes: WebGLTexture | null = null;
  #commands: Command[] = [];
  #enabled = 0;
  readonly #listeners = new Set<() => void>();
  /** When memory was last freed. */
  #freed = 0;
  // Of the picture that is being drawn.
  #now = 0;
  #camera: Camera | undefined;
  #size: readonly [width: number, height: number, ratio: number] = [1, 1, 1];

  /** Call a function when pictures must be drawn again, or when they cannot be; returns its end. */
  watch(listener: () => void): () => void {
    this.#listeners.add(listener);
    this.#start();
    return () => {
      this.#listeners.delete(listener);
      if (this.#listeners.size === 0) this.#free(Infinity);
    };
  }

  /** Points of a cloud that are drawn at most. */
  get maxPoints(): number {
    return this.isSoftware ? SOFTWARE_POINTS : POINTS;
  }

  /** Pixels for one of CSS. */
  get ratio(): number {
    return this.isSoftware ? 1 : Math.min(MAX_RATIO, devicePixelRatio);
  }

  #start(): void {
    if (this.#gl !== null || this.fault !== "") return;
    let gl = this.#open(false);
    if (gl === null) {
      this.fault = "This browser has no WebGL 2, or it is turned off.";
      return;
    }
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    const name = String(gl.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
    this.isSoftware = /swiftshader|llvmpipe|software|basic render/i.test(name);
    if (!this.isSoftware) {
      // Smooth edges cost a graphics card little; a context has them from its beginning on.
      gl.getExtension("WEBGL_lose_context")?.loseContext();
      gl = this.#open(true);
    }
    this.#gl = gl;
  }

  #open(antialias: boolean): WebGL2RenderingContext | null {
    const canvas = new OffscreenCanvas(1, 1);
    const gl = canvas.getContext("webgl2", { antialias, alpha: false, stencil: false });
    if (gl === null) return null;
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      if (this.#gl === gl) this.#lose("The graphics card was lost: waiting for it.");
    });
    canvas.addEventListener("webglcontextrestored", () => {
      if (this.#gl === gl) this.#lose("");
    });
    this.#canvas = canvas;
    return gl;
  }

  /** What was made with the context is gone; it is made again when it is next drawn. */
  #lose(fault: string): void {
    this.fault = fault;
    this.#programs = new Map();
    this.#buffers = new Map();
    this.#tiles = new Map();
    this.#palettes = null;
    this.#enabled = 0;
    for (const listener of [...this.#listeners]) listener();
  }

  /** Free what was last drawn before a time: it is made again when it is drawn. */
  #free(before: number): void {
    for (const [made, { used }] of [...this.#buffers, ...this.#tiles]) {
      if (used < before) this.forget(made);
    }
    this.#freed = this.#now;
  }

  forget(made: Vertices | Cells): void {
    if (made instanceof Vertices) {
      this.#gl?.deleteBuffer(this.#buffers.get(made)?.buffer ?? null);
      this.#buffers.delete(made);
    } else {
      for (const { texture } of this.#tiles.get(made)?.tiles ?? [])
        this.#gl?.deleteTexture(texture);
      this.#tiles.delete(made);
    }
  }

  /**
   * Draw a picture on a canvas, in pixels of the screen.
   *
   * `add` calls `points`, `lines`, `grid`, `solids` and `mesh`. Returns whether it was drawn.
   */
  draw(target: HTMLCanvasElement, camera: Camera, background: Color, add: () => void): boolean {
    const [gl, canvas] = [this.#gl, this.#canvas];
    const context = target.getContext("bitmaprenderer", { alpha: false });
    if (gl === null || canvas === undefined || context === null || this.fault !== "") return false;
    const { width, height } = target;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    this.#now = performance.now();
    if (this.#now - this.#freed > UNUSED) this.#free(this.#now - UNUSED);
    this.#camera = camera;
    this.#size = [width, height, this.ratio];
    this.#commands = [];
    add();
    gl.viewport(0, 0, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(0, 0, width, height);
    gl.clearColor(background[0], background[1], background[2], 1);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    for (const order of [GROUND, SOLID, CLEAR]) {
      gl.depthMask(order === SOLID);
      if (order === SOLID) gl.disable(gl.BLEND);
      else gl.enable(gl.BLEND);
      for (const command of this.#commands) if (command.order === order) command.run(gl);
    }
    this.#commands = [];
    if (gl.isContextLost()) return false;
    context.transferFromImageBitmap(canvas.transferToImageBitmap());
    return true;
  }

  points(points: Points, model: Transform = IDENTITY): void {
    const { paint, alpha = 1 } = points;
    const isClear = alpha < 1 || (paint.kind === "flat" && paint.color[3] < 1);
    this.#add(isClear ? CLEAR : SOLID, (gl) => this.#drawPoints(gl, points, model));
  }

  lines(lines: Lines, model: Transform = IDENTITY): void {
    const isClear = lines.color === undefined || lines.color[3] < 1;
    const order = lines.isGround ? GROUND : isClear ? CLEAR : SOLID;
    this.#add(order, (gl) => this.#drawLines(gl, lines, model));
  }

  solids(solids: Solids, model: Transform = IDENTITY): void {
    this.#add(solids.isClear ? CLEAR : SOLID, (gl) => this.#drawSolids(gl, solids, model));
  }

  mesh(mesh: Mesh, model: Transform = IDENTITY): void {
    this.#add(mesh.color[3] < 1 ? CLEAR : SOLID, (gl) => this.#drawMesh(gl, mesh, model));
  }

  grid(grid: Grid, model: Transform): void {
    this.#add(GROUND, (gl) => this.#drawGrid(gl, grid, model));
  }

  #add(order: number, run: (gl: WebGL2RenderingContext) => void): void {
    this.#commands.push({ order, run });
  }

  #drawPoints(gl: WebGL2RenderingContext, points: Points, model: Transform): void {
    const { vertices, stride, offset = 0, size, paint, alpha = 1 } = points;
    const hasty = this.isHasty && this.isSoftware && points.count > HASTY_POINTS ? HASTY : 1;
    const most = Math.floor(MAX_STRIDE / stride);
    const every = Math.max(1, Math.min((points.every ?? 1) * hasty, most));
    const program = this.#use(gl, "points", model);
    const step = stride * every;
    const attributes: Attribute[] = [{ at: 0, size: 3, stride: step, offset }];
    let color: Color = [1, 1, 1, alpha];
    switch (paint.kind) {
      case "flat":
        color = [paint.color[0], paint.color[1], paint.color[2], paint.color[3] * alpha];
        break;
      case "bgr":
        attributes.push({
          at: 1,
          size: 3,
          type: gl.UNSIGNED_BYTE,
          normalized: true,
          stride: step,
          offset: paint.offset,
        });
        break;
      case "number":
        attributes.push({
          at: 2,
          size: 1,
          type: TYPES[paint.type],
          stride: step,
          offset: paint.offset,
        });
        break;
      case "along":
        gl.uniform4f(program("axis"), paint.axis.x, paint.axis.y, paint.axis.z, paint.from);
        break;
    }
    gl.uniform1i(program("kind"), ["flat", "bgr", "number", "along"].indexOf(paint.kind));
    gl.uniform4f(program("color"), ...color);
    gl.uniform2f(program("size"), ...this.#thickness(size, points.isMetric));
    if ("palette" in paint) {
      gl.uniform2f(program("range"), paint.low, paint.high);
      this.#usePalette(gl, program, paint.palette);
    }
    if (!this.#bind(gl, vertices, attributes)) return;
    const count = Math.ceil(points.count / every);
    gl.drawArrays(gl.POINTS, 0, count);
  }

  /** A size in pixels and 0, or in m and the pixels of 1 m at a distance of 1 m. */
  #thickness(size: number, isMetric = false): [size: number, focus: number] {
    if (!isMetric) return [Math.max(1, size * this.#size[2]), 0];
    return [size, ((this.#camera as Camera).projection[5] as number) * (this.#size[1] / 2)];
  }

  #drawLines(gl: WebGL2RenderingContext, lines: Lines, model: Transform): void {
    const { vertices, count, pairs = false, width, color } = lines;
    const segments = pairs ? count >> 1 : count - 1;
    if (segments < 1) return;
    const program = this.#use(gl, "lines", model);
    const point = color === undefined ? 16 : 12;
    const stride = pairs ? 2 * point : point;
    const bytes = { size: 4, type: gl.UNSIGNED_BYTE, normalized: true, stride };
    const attributes: Attribute[] = [
      { at: 0, size: 3, stride, offset: 0 },
      { at: 1, size: 3, stride, offset: point },
    ];
    if (color === undefined) {
      attributes.push({ at: 2, ...bytes, offset: 12 }, { at: 3, ...bytes, offset: point + 12 });
    }
    gl.uniform1i(program("hasColors"), color === undefined ? 1 : 0);
    gl.uniform4f(program("color"), ...(color ?? ([1, 1, 1, 1] as const)));
    const thickness = this.#thickness(width, lines.isMetric);
    gl.uniform4f(program("screen"), this.#size[0], this.#size[1], ...thickness);
    if (!this.#bind(gl, vertices, attributes, 0)) return;
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, segments);
  }

  #drawSolids(gl: WebGL2RenderingContext, solids: Solids, model: Transform): void {
    const { shape, vertices, count } = solids;
    if (count === 0) return;
    let triangles = this.#shapes.get(shape);
    if (triangles === undefined) {
      triangles = new Vertices(shapeTriangles(shape));
      this.#shapes.set(shape, triangles);
    }
    const program = this.#use(gl, "solids", model);
    gl.uniformMatrix4fv(program("view"), false, this.#modelView(model));
    const stride = INSTANCE;
    const own: Attribute[] = [
      { at: 0, size: 3, stride: 24, offset: 0 },
      { at: 1, size: 3, stride: 24, offset: 12 },
    ];
    const each: Attribute[] = [
      { at: 2, size: 3, stride, offset: 0 },
      { at: 3, size: 4, stride, offset: 12 },
      { at: 4, size: 3, stride, offset: 28 },
      { at: 5, size: 4, stride, offset: 40 },
    ];
    if (!this.#bind(gl, triangles, own) || !this.#bind(gl, vertices, each, 2)) return;
    gl.drawArraysInstanced(gl.TRIANGLES, 0, triangles.data.byteLength / 24, count);
  }

  #drawMesh(gl: WebGL2RenderingContext, mesh: Mesh, model: Transform): void {
    const { vertices, count, color, hasColors = false, scale, isFlat = false } = mesh;
    const program = this.#use(gl, "mesh", model, scale);
    gl.uniformMatrix4fv(program("view"), false, this.#modelView(model));
    gl.uniform3f(program("scale"), scale?.x ?? 1, scale?.y ?? 1, scale?.z ?? 1);
    gl.uniform4f(program("color"), ...color);
    gl.uniform2i(program("flags"), hasColors ? 1 : 0, isFlat ? 1 : 0);
    const stride = hasColors ? 28 : 24;
    const attributes: Attribute[] = [
      { at: 0, size: 3, stride, offset: 0 },
      { at: 1, size: 3, stride, offset: 12 },
    ];
    if (hasColors) {
      const bytes = { size: 4, type: gl.UNSIGNED_BYTE, normalized: true };
      attributes.push({ at: 2, ...bytes, stride, offset: 24 });
    }
    if (this.#bind(gl, vertices, attributes)) gl.drawArrays(gl.TRIANGLES, 0, count);
  }

  #drawGrid(gl: WebGL2RenderingContext, grid: Grid, model: Transform): void {
    const { cells, resolution, palette, alpha } = grid;
    const program = this.#use(gl, "grid", model);
    this.#bind(gl, undefined, []);
    gl.uniform1i(program("cells"), 1);
    gl.uniform1f(program("alpha"), alpha);
    this.#usePalette(gl, program, palette);
    gl.activeTexture(gl.TEXTURE1);
    for (const { texture, x, y, width, height } of this.#upload(gl, cells)) {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform4f(
        program("box"),
        x * resolution,
        y * resolution,
        width * resolution,
        height * resolution,
      );
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
  }

  /** The textures of a map: several if it is larger than one may be. */
  #upload(gl: WebGL2RenderingContext, cells: Cells): readonly Tile[] {
    let known = this.#tiles.get(cells);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    if (known?.width !== cells.width || known.height !== cells.height) {
      this.forget(cells);
      const { width, height } = cells;
      known = { width, height, tiles: makeTiles(gl, cells), used: 0 };
      this.#tiles.set(cells, known);
      cells.changed = [0, cells.height];
    }
    known.used = this.#now;
    const [from, to] = cells.changed;
    cells.changed = [0, 0];
    if (to <= from) return known.tiles;
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, cells.width);
    for (const { texture, x, y, width, height } of known.tiles) {
      const [first, end] = [Math.max(from, y), Math.min(to, y + height)];
      if (end <= first) continue;
      gl.bindTexture(gl.TEXTURE_2D, texture);
      const data = cells.data.subarray(first * cells.width + x);
      const format = [gl.RED, gl.UNSIGNED_BYTE] as const;
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, first - y, width, end - first, ...format, data);
    }
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
    return known.tiles;
  }

  #usePalette(
    gl: WebGL2RenderingContext,
    program: (name: string) => WebGLUniformLocation | null,
    palette: Palette,
  ): void {
    gl.activeTexture(gl.TEXTURE0);
    if (this.#palettes === null) {
      this.#palettes = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, this.#palettes);
      const [width, height] = [256, PALETTES.length];
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
      const format = [gl.RGBA, gl.UNSIGNED_BYTE] as const;
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, ...format, paletteBytes());
      nearest(gl);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.#palettes);
    gl.uniform1i(program("palettes"), 0);
    gl.uniform1i(program("row"), PALETTES.indexOf(palette));
  }

  /** Bind vertices to attributes; `each` is the first one that is per instance. */
  #bind(
    gl: WebGL2RenderingContext,
    vertices: Vertices | undefined,
    attributes: readonly Attribute[],
    each = 99,
  ): boolean {
    if (vertices !== undefined) {
      if (vertices.data.byteLength === 0) return false;
      let known = this.#buffers.get(vertices);
      if (known === undefined) {
        known = { buffer: gl.createBuffer(), version: -1, size: 0, used: 0 };
        this.#buffers.set(vertices, known);
      }
      known.used = this.#now;
      gl.bindBuffer(gl.ARRAY_BUFFER, known.buffer);
      const { data, version } = vertices;
      if (known.version !== version) {
        // A buffer of the same size is used again.
        if (known.size === data.byteLength) gl.bufferSubData(gl.ARRAY_BUFFER, 0, data);
        else gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
        known.version = version;
        known.size = data.byteLength;
      }
    }
    // Those of instances are bound second, and keep the first ones.
    let wanted = each < 99 && each > 0 ? this.#enabled & ((1 << each) - 1) : 0;
    for (const { at, size, type = gl.FLOAT, normalized = false, stride, offset } of attributes) {
      wanted |= 1 << at;
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, type, normalized, stride, offset);
      gl.vertexAttribDivisor(at, at >= each ? 1 : 0);
    }
    for (let at = 0; at < 6; at += 1) {
      if (((this.#enabled & ~wanted) >> at) & 1) gl.disableVertexAttribArray(at);
    }
    this.#enabled = wanted;
    return true;
  }

  #modelView(model: Transform): Float32Array {
    return new Float32Array(product((this.#camera as Camera).view, matrixOf(model)));
  }

  /** Use a program for a model; returns a function for the places of its uniforms. */
  #use(
    gl: WebGL2RenderingContext,
    name: keyof typeof SHADERS,
    model: Transform,
    scale?: Vector,
  ): (name: string) => WebGLUniformLocation | null {
    let known = this.#programs.get(name);
    if (known === undefined) {
      known = { program: compile(gl, SHADERS[name]), uniforms: new Map() };
      this.#programs.set(name, known);
    }
    const { program, uniforms } = known;
    gl.useProgram(program);
    const place = (uniform: string): WebGLUniformLocation | null => {
      let found = uniforms.get(uniform) ?? null;
      if (found === null) {
        found = gl.getUniformLocation(program, uniform);
        if (found !== null) uniforms.set(uniform, found);
      }
      return found;
    };
    // Multiplied here in double precision: maps of towns are far from their origin.
    const camera = this.#camera as Camera;
    const matrix: Matrix = product(camera.matrix, matrixOf(model, scale));
    gl.uniformMatrix4fv(place("matrix"), false, matrix as number[]);
    return place;
  }
}

function compile(
  gl: WebGL2RenderingContext,
  [vertex, fragment]: readonly [vertex: string, fragment: string],
): WebGLProgram {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(type) as WebGLShader;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    gl.deleteShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
      console.error(gl.getShaderInfoLog(shader));
    }
  }
  gl.linkProgram(program);
  return program;
}

function makeTiles(gl: WebGL2RenderingContext, { width, height }: Cells): Tile[] {
  const most = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
  const tiles: Tile[] = [];
  for (let y = 0; y < height; y += most) {
    for (let x = 0; x < width; x += most) {
      const texture = gl.createTexture();
      const tile = { width: Math.min(most, width - x), height: Math.min(most, height - y) };
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R8, tile.width, tile.height);
      nearest(gl);
      tiles.push({ texture, x, y, ...tile });
    }
  }
  return tiles;
}

function nearest(gl: WebGL2RenderingContext): void {
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) {
    gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  }
}

/** The page's one renderer. */
export const renderer = new Renderer();
export type { Renderer };
