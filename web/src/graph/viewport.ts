/** The visible part of the drawing: moved by drag, wheel, pinch and keys. */

import {
  type Bounds,
  type Box,
  marginOf,
  type Point,
  READABLE,
  type Size,
  zoomToFit,
} from "./layout_types";

const MAX_ZOOM = 3;
const MIN_ZOOM = 0.03;
/** The distance of a revealed box from the border, in pixels. */
const MARGIN = 14;
/** How far an arrow key moves the drawing, in pixels. */
const STEP = 60;
/** A pointer that moves less than this does not drag, in pixels. */
const DRAG_START = 4;

export class Viewport {
  /** What it shows after each change, until the user moves it. */
  #shows: "start" | "everything" | null = "start";
  readonly #element: HTMLElement;
  readonly #content: SVGSVGElement;
  readonly #zoomed: (zoom: number) => void;
  readonly #pointers = new Map<number, PointerEvent>();
  #bounds: Bounds = { left: 0, top: 0, width: 0, height: 0 };
  #start: Point = { x: 0, y: 0 };
  #x = 0;
  #y = 0;
  #zoom = 1;
  #dragged = false;

  /** `element` receives the events, `content` is moved, and `zoomed` receives the zoom. */
  constructor(element: HTMLElement, content: SVGSVGElement, zoomed: (zoom: number) => void) {
    this.#element = element;
    this.#content = content;
    this.#zoomed = zoomed;
    element.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    element.addEventListener("pointerdown", (event) => this.#down(event));
    element.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      element.addEventListener(end, ({ pointerId }) => this.#pointers.delete(pointerId));
    }
    // The end of a drag is not a click.
    element.addEventListener("click", (event) => this.#dragged && event.stopPropagation(), true);
    element.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.refit(false)).observe(element);
  }

  /** The size of the visible part, in pixels; that of a usual window while it is hidden. */
  get canvas(): Size {
    const { clientWidth: width, clientHeight: height } = this.#element;
    return width > 0 && height > 0 ? { width, height } : { width: 1280, height: 720 };
  }

  /** Set the bounds of the drawing, and the point to show first if it is too large. */
  contain(bounds: Bounds, start: Point): void {
    this.#bounds = bounds;
    this.#start = start;
    this.#content.style.width = `${bounds.width}px`;
    this.#content.style.height = `${bounds.height}px`;
    this.refit();
  }

  /** Whether the user has moved it. */
  get isMoved(): boolean {
    return this.#shows === null;
  }

  /** Show everything, also after later changes. */
  fit(): void {
    this.#shows = "everything";
    this.refit();
  }

  /** Show what it showed before a change, unless the user has moved it. */
  refit(animated = true): void {
    const { left, top, width, height } = this.#bounds;
    const { canvas } = this;
    if (this.#shows === null || width <= 0 || height <= 0 || this.#element.clientWidth === 0)
      return;
    const fitting = zoomToFit(this.#bounds, canvas);
    // At first, names are readable, even if not all of the drawing has space then.
    this.#zoom = clamped(this.#shows === "start" ? Math.max(READABLE, fitting) : fitting);
    const shift = (visible: number, low: number, length: number, start: number): number => {
      const margin = marginOf(canvas);
      const slack = visible - length * this.#zoom;
      if (slack >= 2 * margin) return slack / 2 - low * this.#zoom;
      const centred = visible / 2 - (start - low) * this.#zoom;
      return Math.min(margin, Math.max(slack - margin, centred)) - low * this.#zoom;
    };
    this.#x = shift(canvas.width, left, width, this.#start.x);
    this.#y = shift(canvas.height, top, height, this.#start.y);
    this.#apply(animated);
  }

  /** Zoom about a point of the element, by default its centre. */
  zoom(factor: number, x?: number, y?: number): void {
    const at = { x: x ?? this.#element.clientWidth / 2, y: y ?? this.#element.clientHeight / 2 };
    const next = clamped(this.#zoom * factor);
    const ratio = next / this.#zoom;
    this.#x = at.x - (at.x - this.#x) * ratio;
    this.#y = at.y - (at.y - this.#y) * ratio;
    this.#zoom = next;
    this.#shows = null;
    this.#apply(x === undefined);
  }

  pan(dx: number, dy: number, animated = true): void {
    this.#x += dx;
    this.#y += dy;
    this.#shows = null;
    this.#apply(animated);
  }

  /** Move as little as possible to make a box visible, apart from the covered part. */
  reveal({ x, y, width, height }: Box, covered = { width: 0, height: 0 }): void {
    const clientWidth = this.#element.clientWidth - covered.width;
    const clientHeight = this.#element.clientHeight - covered.height;
    const distance = (centre: number, size: number, shift: number, room: number): number => {
      const low = (centre - size / 2) * this.#zoom + shift;
      const high = (centre + size / 2) * this.#zoom + shift;
      if (low < MARGIN) return MARGIN - low;
      return high > room - MARGIN ? room - MARGIN - high : 0;
    };
    const dx = distance(x, width, this.#x, clientWidth);
    const dy = distance(y, height, this.#y, clientHeight);
    if (dx === 0 && dy === 0) return;
    const shows = this.#shows;
    this.pan(dx, dy);
    // The user did not move it.
    this.#shows = shows;
  }

  #apply(animated: boolean): void {
    this.#content.classList.toggle("animated", animated);
    // With a 3D transform, browsers move it as one layer and do not repaint it.
    this.#content.style.transform = `translate3d(${this.#x}px, ${this.#y}px, 0) scale(${this.#zoom})`;
    this.#zoomed(this.#zoom);
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const { left, top } = this.#element.getBoundingClientRect();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    // A pinch on a touchpad arrives as small wheel steps with Ctrl.
    const speed = event.ctrlKey ? 0.01 : 0.0015;
    const factor = Math.exp(-event.deltaY * lines * speed);
    this.zoom(factor, event.clientX - left, event.clientY - top);
  }

  #down(event: PointerEvent): void {
    if (event.button !== 0) return;
    if (this.#pointers.size === 0) this.#dragged = false;
    this.#pointers.set(event.pointerId, event);
  }

  #move(event: PointerEvent): void {
    const previous = this.#pointers.get(event.pointerId);
    if (previous === undefined) return;
    if (event.buttons === 0) {
      this.#pointers.delete(event.pointerId);
      return;
    }
    const [dx, dy] = [event.clientX - previous.clientX, event.clientY - previous.clientY];
    const other = [...this.#pointers.values()].find(
      ({ pointerId }) => pointerId !== event.pointerId,
    );
    if (!this.#dragged) {
      if (Math.hypot(dx, dy) < DRAG_START) return;
      this.#dragged = true;
      this.#element.setPointerCapture(event.pointerId);
    }
    this.#pointers.set(event.pointerId, event);
    if (other === undefined) {
      this.pan(dx, dy, false);
      return;
    }
    const { left, top } = this.#element.getBoundingClientRect();
    const distance = (from: PointerEvent): number =>
      Math.hypot(from.clientX - other.clientX, from.clientY - other.clientY);
    const [x, y] = [(event.clientX + other.clientX) / 2, (event.clientY + other.clientY) / 2];
    this.pan(dx / 2, dy / 2, false);
    if (distance(previous) > 0) this.zoom(distance(event) / distance(previous), x - left, y - top);
  }

  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const moves: Record<string, () => void> = {
      ArrowLeft: () => this.pan(STEP, 0),
      ArrowRight: () => this.pan(-STEP, 0),
      ArrowUp: () => this.pan(0, STEP),
      ArrowDown: () => this.pan(0, -STEP),
      "+": () => this.zoom(1.25),
      "=": () => this.zoom(1.25),
      "-": () => this.zoom(0.8),
      "0": () => this.fit(),
    };
    const move = moves[event.key];
    if (move === undefined) return;
    event.preventDefault();
    move();
  }
}

const clamped = (zoom: number): number => Math.min(MAX_ZOOM, Math.max(MIN_ZOOM, zoom));
