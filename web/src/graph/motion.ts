// How the marks on the screen get to where they belong.

import { type EdgeMark, type ElementMark, put } from "./marks";
import { between, curve } from "./ways";

/** How long things take to their new places, in ms. */
const GLIDE = 350;
/** More than these are set down at once: each frame of a glide costs time for each of them. */
export const MANY = 250;

export class Motion {
  readonly #elements: ReadonlyMap<string, ElementMark>;
  readonly #edges: ReadonlyMap<string, EdgeMark>;
  #down = false;
  #frame = 0;

  /** Moves what is in the maps at the time. */
  constructor(elements: ReadonlyMap<string, ElementMark>, edges: ReadonlyMap<string, EdgeMark>) {
    this.#elements = elements;
    this.#edges = edges;
  }

  /** Set all down at once; `down` tells whether the layers lie from the top down. */
  jump(down: boolean): void {
    this.#stop(down);
    this.#settle();
  }

  /** Let all glide from where it is. */
  glide(down: boolean): void {
    this.#stop(down);
    this.#start(performance.now());
  }

  #stop(down: boolean): void {
    cancelAnimationFrame(this.#frame);
    this.#down = down;
  }

  #start(since: number): void {
    this.#frame = requestAnimationFrame((now) => {
      const part = Math.min(1, Math.max(0, (now - since) / GLIDE));
      this.#step(1 - (1 - part) ** 3);
      if (part < 1) this.#start(since);
    });
  }

  /** Set all down at its place; very many arrows in portions, a frame for each. */
  #settle(): void {
    this.#move(1);
    let left = MANY;
    for (const mark of this.#edges.values()) {
      if (left === 0) {
        this.#frame = requestAnimationFrame(() => this.#settle());
        return;
      }
      if (this.#bend(mark, 1)) left -= 1;
    }
  }

  #step(part: number): void {
    this.#move(part);
    for (const mark of this.#edges.values()) this.#bend(mark, part);
  }

  #move(part: number): void {
    for (const mark of this.#elements.values()) {
      const { from, to } = mark;
      mark.at = { ...to, x: mix(from.x, to.x, part), y: mix(from.y, to.y, part) };
      put(mark.mark, "transform", `translate(${mark.at.x} ${mark.at.y})`);
    }
  }

  /** Tells whether the arrow looks otherwise now. */
  #bend(mark: EdgeMark, part: number): boolean {
    const { from, to, edge } = mark;
    const label = {
      x: mix(from.label.x, to.label.x, part),
      y: mix(from.label.y, to.label.y, part),
    };
    const points = part === 1 ? to.points : between(from.points, to.points, part);
    mark.at = { points, label };
    const ends = [this.#elements.get(edge.from), this.#elements.get(edge.to)] as const;
    if (ends[0] === undefined || ends[1] === undefined) return false;
    const middles = [ends[0].at, ends[1].at] as const;
    const { line, heads } = curve(points, middles, this.#down, edge.bothWays);
    const high = edge.label === "" ? 4 : -3;
    const bent = put(mark.line, "d", line);
    if (bent) put(mark.hit, "d", line);
    const turned = put(mark.heads, "d", heads);
    const moved = put(mark.words, "transform", `translate(${label.x} ${label.y + high})`);
    return bent || turned || moved;
  }
}

const mix = (a: number, b: number, part: number): number => a + (b - a) * part;
