/** Moves the elements and edges of the drawing to their places. */

import { setAttribute } from "../dom";
import { curve, interpolate } from "./edge_paths";
import type { EdgeMark, ElementMark } from "./shapes";

/** The duration of the animation, in ms. */
const DURATION = 350;
/** More marks than this are not animated, as each frame would take too long. */
export const MAX_ANIMATED = 250;

export class Animator {
  readonly #elements: ReadonlyMap<string, ElementMark>;
  readonly #edges: ReadonlyMap<string, EdgeMark>;
  #down = false;
  #frame = 0;

  /** The maps hold the current marks. */
  constructor(elements: ReadonlyMap<string, ElementMark>, edges: ReadonlyMap<string, EdgeMark>) {
    this.#elements = elements;
    this.#edges = edges;
  }

  /** Move all marks at once; `down` says whether the layers go from top to bottom. */
  jump(down: boolean): void {
    this.#stop(down);
    this.#settle();
  }

  /** Animate all marks from where they are now. */
  animate(down: boolean): void {
    this.#stop(down);
    this.#start(performance.now());
  }

  #stop(down: boolean): void {
    cancelAnimationFrame(this.#frame);
    this.#down = down;
  }

  #start(since: number): void {
    this.#frame = requestAnimationFrame((now) => {
      const part = Math.min(1, Math.max(0, (now - since) / DURATION));
      this.#step(1 - (1 - part) ** 3);
      if (part < 1) this.#start(since);
    });
  }

  /** Move all marks to their places; very many edges in portions, one for each frame. */
  #settle(): void {
    this.#moveElements(1);
    let left = MAX_ANIMATED;
    for (const mark of this.#edges.values()) {
      if (left === 0) {
        this.#frame = requestAnimationFrame(() => this.#settle());
        return;
      }
      if (this.#moveEdge(mark, 1)) left -= 1;
    }
  }

  #step(part: number): void {
    this.#moveElements(part);
    for (const mark of this.#edges.values()) this.#moveEdge(mark, part);
  }

  #moveElements(part: number): void {
    for (const mark of this.#elements.values()) {
      const { from, to } = mark;
      mark.at = { ...to, x: mix(from.x, to.x, part), y: mix(from.y, to.y, part) };
      setAttribute(mark.mark, "transform", `translate(${mark.at.x} ${mark.at.y})`);
    }
  }

  /** Redraw an edge; returns whether it changed. */
  #moveEdge(mark: EdgeMark, part: number): boolean {
    const { from, to, edge } = mark;
    const label = {
      x: mix(from.label.x, to.label.x, part),
      y: mix(from.label.y, to.label.y, part),
    };
    const points = part === 1 ? to.points : interpolate(from.points, to.points, part);
    mark.at = { points, label };
    const ends = [this.#elements.get(edge.from), this.#elements.get(edge.to)] as const;
    if (ends[0] === undefined || ends[1] === undefined) return false;
    const centres = [ends[0].at, ends[1].at] as const;
    const { line, heads } = curve(points, centres, this.#down, edge.bothWays);
    const high = edge.label === "" ? 4 : -3;
    const lineChanged = setAttribute(mark.line, "d", line);
    if (lineChanged) setAttribute(mark.hit, "d", line);
    const headsChanged = setAttribute(mark.heads, "d", heads);
    const labelChanged = setAttribute(
      mark.label,
      "transform",
      `translate(${label.x} ${label.y + high})`,
    );
    return lineChanged || headsChanged || labelChanged;
  }
}

const mix = (a: number, b: number, part: number): number => a + (b - a) * part;
