/** The drawing on the screen: each element and edge is created once, and then only changed. */

import { h, reorder, setAttribute, setText, svg } from "../dom";
import type { Rates } from "../model";
import { NO_RATES } from "../rates";
import { Animator, MAX_ANIMATED } from "./animator";
import type { Box, Layout } from "./layout_types";
import type { Edge, Group, Picture, Element as PictureElement } from "./picture";
import {
  type EdgeMark,
  type ElementMark,
  elementContent,
  makeEdge,
  makeElement,
  rateLabel,
  shortened,
} from "./shapes";

/** How many new marks are drawn in one frame. */
const PORTION = 100;
/** Below this zoom, types and rates are too small to read, and hidden. */
const FAR = 0.5;
/** Below this zoom, names are hidden, and namespaces have names of a readable size instead. */
const FARTHER = 0.3;
/** The height of the row above the members of a namespace, for its name. */
const CAPTION_ROW = 20;

export interface Actions {
  /** An element was clicked, or Enter was pressed on it. */
  choose(element: PictureElement): void;
  /** An element got the focus by the keyboard. */
  focus(box: Box): void;
}

export class Drawing {
  readonly root = svg("svg", { class: "drawing" });
  readonly element = h("div", { class: "sheet" }, this.root);
  readonly #groups = svg("g");
  readonly #edges = svg("g");
  readonly #elements = svg("g");
  /** Names of namespaces, above everything: they stay readable from afar. */
  readonly #titles = svg("g");
  readonly #actions: Actions;
  readonly #elementMarks = new Map<string, ElementMark>();
  readonly #edgeMarks = new Map<string, EdgeMark>();
  readonly #groupMarks = new Map<string, { frame: SVGRectElement; title: SVGTextElement }>();
  readonly #animator = new Animator(this.#elementMarks, this.#edgeMarks);
  readonly #reducedMotion = matchMedia("(prefers-reduced-motion: reduce)");
  #down = false;
  #nextPortion = 0;
  #rates = NO_RATES;
  #chosen: string | null = null;

  constructor(actions: Actions) {
    this.#actions = actions;
    this.root.append(this.#groups, this.#edges, this.#elements, this.#titles);
    // One listener for all elements. It is outside the SVG, where listeners for the focus would
    // make their elements focusable.
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
      this.element.addEventListener(enter, ({ target }) => this.#highlight(target, true));
      this.element.addEventListener(leave, ({ target }) => this.#highlight(target, false));
    }
    this.element.addEventListener("focusin", ({ target }) => {
      const mark = this.#markOf(target);
      if (mark?.mark.matches(":focus-visible")) this.#actions.focus(mark.to);
    });
    this.element.addEventListener("pointerover", ({ target }) => this.#addTooltip(target));
  }

  /**
   * Draw a picture in its layout; marks that stay are animated to their new places.
   *
   * Many new marks are drawn in portions, so that the page stays responsive.
   */
  draw(picture: Picture, layout: Layout, rates: Rates): void {
    const { down } = layout;
    cancelAnimationFrame(this.#nextPortion);
    const elements = portion(picture.elements, this.#elementMarks, PORTION);
    const fresh = elements.filter(({ id }) => !this.#elementMarks.has(id)).length;
    const edges = portion(picture.edges, this.#edgeMarks, PORTION - fresh);
    const isComplete =
      elements.length === picture.elements.length && edges.length === picture.edges.length;
    const isTurned = down !== this.#down;
    this.#down = down;
    this.#drawGroups(picture.groups, layout);
    this.#drawElements(elements, layout);
    this.#drawEdges(edges, layout);
    this.updateRates(rates);
    this.choose(this.#chosen);
    const isJump =
      this.#reducedMotion.matches ||
      document.hidden ||
      isTurned ||
      !isComplete ||
      this.#edgeMarks.size > MAX_ANIMATED;
    if (isJump) this.#animator.jump(down);
    else this.#animator.animate(down);
    if (!isComplete) {
      // One portion for each frame: timers could run twice between two frames.
      this.#nextPortion = requestAnimationFrame(() => this.draw(picture, layout, this.#rates));
    }
  }

  /** Update the rates. */
  updateRates(rates: Rates): void {
    this.#rates = rates;
    for (const mark of this.#edgeMarks.values()) {
      const { label, title, stroke, idle, drops } = rateLabel(mark.edge, rates);
      setText(mark.rate, label);
      if (mark.title !== undefined) setText(mark.title, title);
      if (mark.stroke !== stroke) mark.line.style.strokeWidth = String(stroke);
      mark.stroke = stroke;
      mark.mark.classList.toggle("idle", idle);
      mark.mark.classList.toggle("drops", drops);
    }
  }

  /** Adapt to the zoom: 1 is the original size. */
  setZoom(zoom: number): void {
    this.root.classList.toggle("far", zoom < FAR);
    this.root.classList.toggle("farther", zoom < FARTHER);
    this.#titles.style.setProperty("--zoom", String(zoom));
  }

  /** Highlight an element and its neighbours; null for none. */
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
      setAttribute(mark, "aria-pressed", String(each === id));
    }
  }

  /** Focus an element. */
  focus(id: string): void {
    this.#elementMarks.get(id)?.mark.focus({ preventScroll: true });
  }

  #markOf(target: EventTarget | null): ElementMark | undefined {
    const mark = target instanceof Element ? target.closest<SVGGElement>(".element") : null;
    return this.#elementMarks.get(mark?.dataset.id ?? "");
  }

  #choose(target: EventTarget | null): void {
    const mark = this.#markOf(target);
    if (mark !== undefined) this.#actions.choose(mark.element);
  }

  /** Highlight the edges of an element. */
  #highlight(target: EventTarget | null, on: boolean): void {
    const id = this.#markOf(target)?.element.id;
    if (id === undefined) return;
    for (const { edge, mark } of this.#edgeMarks.values()) {
      if (edge.from === id || edge.to === id) mark.classList.toggle("lit", on);
    }
  }

  /** Add a tooltip to the edge under the pointer; the others need none. */
  #addTooltip(target: EventTarget | null): void {
    const mark = target instanceof Element ? target.closest<SVGGElement>(".edge") : null;
    const pointed = this.#edgeMarks.get(mark?.dataset.id ?? "");
    if (pointed === undefined) return;
    pointed.title ??= pointed.mark.insertBefore(svg("title"), pointed.mark.firstChild);
    setText(pointed.title, rateLabel(pointed.edge, this.#rates).title);
  }

  #drawGroups(groups: readonly Group[], layout: Layout): void {
    removeExcept(this.#groupMarks, new Set(groups.map(({ name }) => name)), ({ frame, title }) => {
      frame.remove();
      title.remove();
    });
    for (const { name, parent } of groups) {
      const box = layout.groups.get(name);
      if (box === undefined) continue;
      let mark = this.#groupMarks.get(name);
      if (mark === undefined) {
        const title = svg("text", { class: "group-name" }, name);
        title.classList.toggle("inner", parent !== null);
        mark = { frame: svg("rect", { class: "group", rx: 8 }), title };
        this.#groupMarks.set(name, mark);
      }
      const { frame, title } = mark;
      const { x, y, width, height } = box;
      const [left, top] = [x - width / 2, y - height / 2];
      setAttribute(frame, "x", String(left));
      setAttribute(frame, "y", String(top));
      setAttribute(frame, "width", String(width));
      setAttribute(frame, "height", String(height));
      setAttribute(title, "x", String(left + 10));
      setAttribute(title, "y", String(top + CAPTION_ROW));
      // In the smallest font.
      setText(title, shortened(name, Math.floor((width - 20) / (LETTER * MIN_CAPTION))));
      title.style.setProperty("--largest", `${captionSize(name, width)}px`);
      this.#groups.append(frame);
      this.#titles.append(title);
    }
  }

  #drawElements(elements: readonly PictureElement[], layout: Layout): void {
    removeExcept(this.#elementMarks, new Set(elements.map(({ id }) => id)), ({ mark }) =>
      mark.remove(),
    );
    const isLarge = elements.length + this.#elementMarks.size > MAX_ANIMATED;
    for (const element of elements) {
      const to = layout.boxes.get(element.id);
      if (to === undefined) continue;
      const old = this.#elementMarks.get(element.id);
      if (old === undefined) {
        const mark = makeElement(element, to);
        this.#elementMarks.set(element.id, { element, at: to, from: to, to, mark });
        mark.classList.toggle("fresh", !isLarge);
        continue;
      }
      const { element: previous, to: box } = old;
      const shown = [previous.label, previous.second, previous.fault, box.width, box.height];
      const next = [element.label, element.second, element.fault, to.width, to.height];
      if (shown.join("\n") !== next.join("\n")) {
        old.mark.replaceChildren(...elementContent(element, to));
      }
      setAttribute(old.mark, "aria-label", element.about);
      old.mark.classList.toggle("unreachable", element.fault !== "");
      Object.assign(old, { element, from: old.at, to });
    }
    // The tab key visits elements in the direction of the edges.
    const order = [...this.#elementMarks.values()].sort(
      this.#down
        ? (a, b) => a.to.y - b.to.y || a.to.x - b.to.x
        : (a, b) => a.to.x - b.to.x || a.to.y - b.to.y,
    );
    reorder(
      this.#elements,
      order.map(({ mark }) => mark),
    );
  }

  #drawEdges(edges: readonly Edge[], layout: Layout): void {
    removeExcept(this.#edgeMarks, new Set(edges.map(({ id }) => id)), ({ mark }) => mark.remove());
    const isLarge = edges.length + this.#elementMarks.size > MAX_ANIMATED;
    for (const edge of edges) {
      const to = layout.links.get(edge.id);
      if (to === undefined) continue;
      let mark = this.#edgeMarks.get(edge.id);
      if (mark === undefined) {
        mark = makeEdge(edge, to);
        this.#edgeMarks.set(edge.id, mark);
        mark.mark.classList.toggle("fresh", !isLarge);
        this.#edges.append(mark.mark);
      }
      mark.mark.classList.toggle("dashed", edge.dashed);
      mark.mark.classList.toggle("latched", edge.latched);
      mark.mark.classList.toggle("conflict", edge.conflict !== "");
      Object.assign(mark, { edge, from: mark.at, to });
    }
  }
}

/** The smallest font for a namespace's name, in pixels, and how wide its letters are: a part of that. */
const MIN_CAPTION = 12;
const LETTER = 0.7;

/** The largest font for a namespace's name, in pixels, with which it covers no member. */
function captionSize(name: string, width: number): number {
  return Math.max(MIN_CAPTION, Math.min(CAPTION_ROW, (width - 20) / (LETTER * name.length)));
}

/** All that are drawn already, and some of the others. */
function portion<T extends { id: string }>(
  all: readonly T[],
  drawn: ReadonlyMap<string, unknown>,
  limit: number,
): readonly T[] {
  let left = limit;
  return all.filter(({ id }) => drawn.has(id) || left-- > 0);
}

/** Remove the marks with other ids. */
function removeExcept<T>(
  marks: Map<string, T>,
  ids: ReadonlySet<string>,
  remove: (mark: T) => void,
): void {
  for (const [id, mark] of marks) {
    if (ids.has(id)) continue;
    remove(mark);
    marks.delete(id);
  }
}
