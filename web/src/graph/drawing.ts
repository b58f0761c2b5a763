// The picture on the screen: each element and arrow is made once, and then only changed.

import { h, say, svg } from "../dom";
import type { Rates } from "../model";
import { NO_RATES } from "../rates";
import { flowText } from "./flow";
import { type EdgeMark, type ElementMark, look, makeEdge, makeElement, put } from "./marks";
import { MANY, Motion } from "./motion";
import { rising } from "./order";
import type { Element as Drawn, Edge, Group, Picture } from "./picture";
import type { Box, Places } from "./places";

/** So many new marks are drawn at once. */
const PORTION = 100;
const FAR = 0.35;

export interface Acts {
  /** An element was clicked on, or Enter pressed. */
  choose(element: Drawn): void;
  /** The keyboard's focus came to an element. */
  visit(box: Box): void;
}

export class Drawing {
  readonly root = svg("svg", { class: "drawing" });
  readonly element = h("div", { class: "sheet" }, this.root);
  readonly #groups = svg("g");
  readonly #edges = svg("g");
  readonly #elements = svg("g");
  /** Names of namespaces, over everything: from afar they are all that can be read. */
  readonly #titles = svg("g");
  readonly #acts: Acts;
  readonly #elementMarks = new Map<string, ElementMark>();
  readonly #edgeMarks = new Map<string, EdgeMark>();
  readonly #groupMarks = new Map<string, { frame: SVGRectElement; title: SVGTextElement }>();
  readonly #motion = new Motion(this.#elementMarks, this.#edgeMarks);
  readonly #still = matchMedia("(prefers-reduced-motion: reduce)");
  #down = false;
  #rest = 0;
  #rates = NO_RATES;
  #chosen: string | null = null;

  constructor(acts: Acts) {
    this.#acts = acts;
    this.root.append(this.#groups, this.#edges, this.#elements, this.#titles);
    // One listener for all, for there may be a thousand of them; and not within the drawing, where
    // whatever listens to the focus may have it.
    this.element.addEventListener("click", ({ target }) => this.#choose(target));
    this.element.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      this.#choose(event.target);
    });
    for (const [enter, leave] of [
      ["pointerover", "pointerout"],
      ["focusin", "focusout"],
    ] as const) {
      this.element.addEventListener(enter, ({ target }) => this.#light(target, true));
      this.element.addEventListener(leave, ({ target }) => this.#light(target, false));
    }
    this.element.addEventListener("focusin", ({ target }) => {
      const mark = this.#markOf(target);
      if (mark?.mark.matches(":focus-visible")) this.#acts.visit(mark.to);
    });
    this.element.addEventListener("pointerover", ({ target }) => this.#entitle(target));
  }

  /**
   * Draw a picture at its places; what was there before glides to where it is now.
   *
   * Very much that is new is drawn in portions, so that the page answers in between.
   */
  draw(picture: Picture, places: Places, down: boolean, rates: Rates): void {
    cancelAnimationFrame(this.#rest);
    const elements = portion(picture.elements, this.#elementMarks, PORTION);
    const fresh = elements.filter(({ id }) => !this.#elementMarks.has(id)).length;
    const edges = portion(picture.edges, this.#edgeMarks, PORTION - fresh);
    const whole =
      elements.length === picture.elements.length && edges.length === picture.edges.length;
    const turned = down !== this.#down;
    this.#down = down;
    const focused = document.activeElement;
    this.#drawGroups(picture.groups, places);
    this.#drawElements(elements, places);
    this.#drawEdges(edges, places);
    if (focused instanceof SVGElement && focused.isConnected)
      focused.focus({ preventScroll: true });
    this.measure(rates);
    this.choose(this.#chosen);
    const jumps =
      this.#still.matches || document.hidden || turned || !whole || this.#edgeMarks.size > MANY;
    if (jumps) this.#motion.jump(down);
    else this.#motion.glide(down);
    if (!whole) {
      // One portion a frame: timers may run twice between two, which then has twice the work.
      this.#rest = requestAnimationFrame(() => this.draw(picture, places, down, this.#rates));
    }
  }

  /** Bring the numbers up to date. */
  measure(rates: Rates): void {
    this.#rates = rates;
    for (const mark of this.#edgeMarks.values()) {
      const { label, title, stroke, idle, drops } = flowText(mark.edge, rates);
      say(mark.rate, label);
      if (mark.title !== undefined) say(mark.title, title);
      if (mark.stroke !== stroke) mark.line.style.strokeWidth = String(stroke);
      mark.stroke = stroke;
      mark.mark.classList.toggle("idle", idle);
      mark.mark.classList.toggle("drops", drops);
    }
  }

  /** Tell how near it is looked at: 1 is its own size. */
  zoom(zoom: number): void {
    // Far away, words are too small to read and only cost time; names of namespaces stay.
    this.root.classList.toggle("far", zoom < FAR);
    this.root.classList.toggle("farther", zoom < FAR / 2);
    this.#titles.style.setProperty("--zoom", String(zoom));
  }

  /** Let an element and its neighbours stand out; none with null. */
  choose(id: string | null): void {
    this.#chosen = id;
    const known = id !== null && this.#elementMarks.has(id);
    this.root.classList.toggle("chosen", known);
    const near = new Set([id]);
    for (const { edge, mark } of this.#edgeMarks.values()) {
      const touches = edge.from === id || edge.to === id;
      mark.classList.toggle("near", touches);
      if (touches) near.add(edge.from).add(edge.to);
    }
    for (const [each, { mark }] of this.#elementMarks) {
      mark.classList.toggle("near", near.has(each));
      put(mark, "aria-pressed", String(each === id));
    }
  }

  /** Give an element the keyboard. */
  focus(id: string): void {
    this.#elementMarks.get(id)?.mark.focus({ preventScroll: true });
  }

  #markOf(target: EventTarget | null): ElementMark | undefined {
    const mark = target instanceof Element ? target.closest<SVGGElement>(".element") : null;
    return this.#elementMarks.get(mark?.dataset.id ?? "");
  }

  #choose(target: EventTarget | null): void {
    const mark = this.#markOf(target);
    if (mark !== undefined) this.#acts.choose(mark.element);
  }

  /** Let the arrows of an element stand out. */
  #light(target: EventTarget | null, on: boolean): void {
    const id = this.#markOf(target)?.element.id;
    if (id === undefined) return;
    for (const { edge, mark } of this.#edgeMarks.values()) {
      if (edge.from === id || edge.to === id) mark.classList.toggle("lit", on);
    }
  }

  /** Give the arrow that is pointed at its title; the others need none. */
  #entitle(target: EventTarget | null): void {
    const mark = target instanceof Element ? target.closest<SVGGElement>(".edge") : null;
    const pointed = this.#edgeMarks.get(mark?.dataset.id ?? "");
    if (pointed === undefined) return;
    pointed.title ??= pointed.mark.insertBefore(svg("title"), pointed.mark.firstChild);
    say(pointed.title, flowText(pointed.edge, this.#rates).title);
  }

  #drawGroups(groups: readonly Group[], places: Places): void {
    keep(this.#groupMarks, new Set(groups.map(({ name }) => name)), ({ frame, title }) => {
      frame.remove();
      title.remove();
    });
    for (const { name } of groups) {
      const box = places.groups.get(name);
      if (box === undefined) continue;
      let mark = this.#groupMarks.get(name);
      if (mark === undefined) {
        const title = svg("text", { class: "group-name" }, name);
        mark = { frame: svg("rect", { class: "group", rx: 8 }), title };
        this.#groupMarks.set(name, mark);
      }
      const { frame, title } = mark;
      const { x, y, width, height } = box;
      const [left, top] = [x - width / 2, y - height / 2];
      put(frame, "x", String(left));
      put(frame, "y", String(top));
      put(frame, "width", String(width));
      put(frame, "height", String(height));
      put(title, "x", String(left + 10));
      put(title, "y", String(top + 6));
      this.#groups.append(frame);
      this.#titles.append(title);
    }
  }

  #drawElements(elements: readonly Drawn[], places: Places): void {
    keep(this.#elementMarks, new Set(elements.map(({ id }) => id)), ({ mark }) => mark.remove());
    const busy = elements.length + this.#elementMarks.size > MANY;
    for (const element of elements) {
      const to = places.boxes.get(element.id);
      if (to === undefined) continue;
      const old = this.#elementMarks.get(element.id);
      if (old === undefined) {
        const mark = makeElement(element, to);
        this.#elementMarks.set(element.id, { element, at: to, from: to, to, mark });
        mark.classList.toggle("fresh", !busy);
        continue;
      }
      const { element: before, to: was } = old;
      const looks = [before.label, before.second, was.width, was.height].join("\n");
      if (looks !== [element.label, element.second, to.width, to.height].join("\n")) {
        old.mark.replaceChildren(...look(element, to));
      }
      put(old.mark, "aria-label", element.about);
      Object.assign(old, { element, from: old.at, to });
    }
    // The keyboard goes from element to element as the eye does: in the direction of the arrows.
    const order = [...this.#elementMarks.values()].sort(
      this.#down
        ? (a, b) => a.to.y - b.to.y || a.to.x - b.to.x
        : (a, b) => a.to.x - b.to.x || a.to.y - b.to.y,
    );
    const ranks = new Map<Element, number>(order.map(({ mark }, rank) => [mark, rank]));
    const stays = rising([...this.#elements.children].map((child) => ranks.get(child) as number));
    let next: SVGGElement | null = null;
    for (const [rank, { mark }] of [...order.entries()].reverse()) {
      // What is moved costs as much as what is new.
      if (!stays.has(rank)) this.#elements.insertBefore(mark, next);
      next = mark;
    }
  }

  #drawEdges(edges: readonly Edge[], places: Places): void {
    keep(this.#edgeMarks, new Set(edges.map(({ id }) => id)), ({ mark }) => mark.remove());
    const busy = edges.length + this.#elementMarks.size > MANY;
    for (const edge of edges) {
      const to = places.links.get(edge.id);
      if (to === undefined) continue;
      let mark = this.#edgeMarks.get(edge.id);
      if (mark === undefined) {
        mark = makeEdge(edge, to);
        this.#edgeMarks.set(edge.id, mark);
        mark.mark.classList.toggle("fresh", !busy);
        this.#edges.append(mark.mark);
      }
      mark.mark.classList.toggle("dashed", edge.dashed);
      mark.mark.classList.toggle("latched", edge.latched);
      Object.assign(mark, { edge, from: mark.at, to });
    }
  }
}

/** Those that are drawn already, and so many of the others. */
function portion<T extends { id: string }>(
  all: readonly T[],
  drawn: ReadonlyMap<string, unknown>,
  most: number,
): readonly T[] {
  let left = most;
  return all.filter(({ id }) => drawn.has(id) || left-- > 0);
}

/** Let go of what is no longer there. */
function keep<T>(marks: Map<string, T>, ids: ReadonlySet<string>, gone: (mark: T) => void): void {
  for (const [id, mark] of marks) {
    if (ids.has(id)) continue;
    gone(mark);
    marks.delete(id);
  }
}
