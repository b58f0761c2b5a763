// The part of the drawing that is in sight: moved by drag, wheel, pinch and keys.

import type { Bounds, Box } from "./places";

const CLOSEST = 3;
const FARTHEST = 0.03;
/** Small graphs are not blown up to the size of the window. */
const LARGEST_FIT = 1.2;
const MARGIN = 28;
const STEP = 60;
const STILL = 4;

export class Viewport {
  /** Until its user has moved it, it shows everything. */
  fits = true;
  readonly #element: HTMLElement;
  readonly #content: SVGSVGElement;
  readonly #zoomed: (zoom: number) => void;
  readonly #pointers = new Map<number, PointerEvent>();
  #bounds: Bounds = { left: 0, top: 0, width: 0, height: 0 };
  #x = 0;
  #y = 0;
  #zoom = 1;
  #dragged = false;

  /** `element` catches what the user does, `content` is moved, and `zoomed` told how near it is. */
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
    // The end of a drag is no click on whatever lies there.
    element.addEventListener("click", (event) => this.#dragged && event.stopPropagation(), true);
    element.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.fits && this.fit(false)).observe(element);
  }

  get aspect(): number {
    const { clientWidth, clientHeight } = this.#element;
    return clientWidth > 0 && clientHeight > 0 ? clientWidth / clientHeight : 1.6;
  }

  get width(): number {
    return this.#element.clientWidth;
  }

  /** The drawing has other bounds now. */
  contain(bounds: Bounds): void {
    this.#bounds = bounds;
    this.#content.style.width = `${bounds.width}px`;
    this.#content.style.height = `${bounds.height}px`;
    if (this.fits) this.fit();
  }

  /** Show everything, and go on doing so. */
  fit(gently = true): void {
    this.fits = true;
    const { left, top, width, height } = this.#bounds;
    const { clientWidth, clientHeight } = this.#element;
    if (width <= 0 || height <= 0 || clientWidth === 0) return;
    const room = (length: number): number => Math.max(40, length - 2 * MARGIN);
    this.#zoom = limited(
      Math.min(LARGEST_FIT, room(clientWidth) / width, room(clientHeight) / height),
    );
    this.#x = (clientWidth - width * this.#zoom) / 2 - left * this.#zoom;
    this.#y = (clientHeight - height * this.#zoom) / 2 - top * this.#zoom;
    this.#apply(gently);
  }

  /** Zoom about a point of the element, by default its middle. */
  zoom(factor: number, x?: number, y?: number): void {
    const at = { x: x ?? this.#element.clientWidth / 2, y: y ?? this.#element.clientHeight / 2 };
    const next = limited(this.#zoom * factor);
    const real = next / this.#zoom;
    this.#x = at.x - (at.x - this.#x) * real;
    this.#y = at.y - (at.y - this.#y) * real;
    this.#zoom = next;
    this.fits = false;
    this.#apply(x === undefined);
  }

  pan(dx: number, dy: number, gently = true): void {
    this.#x += dx;
    this.#y += dy;
    this.fits = false;
    this.#apply(gently);
  }

  /** Move as little as it takes to bring a box into sight, beside or above what covers a part. */
  reveal({ x, y, width, height }: Box, covered = { width: 0, height: 0 }): void {
    const clientWidth = this.#element.clientWidth - covered.width;
    const clientHeight = this.#element.clientHeight - covered.height;
    const off = (middle: number, size: number, shift: number, room: number): number => {
      const low = (middle - size / 2) * this.#zoom + shift;
      const high = (middle + size / 2) * this.#zoom + shift;
      if (low < MARGIN / 2) return MARGIN / 2 - low;
      return high > room - MARGIN / 2 ? room - MARGIN / 2 - high : 0;
    };
    const dx = off(x, width, this.#x, clientWidth);
    const dy = off(y, height, this.#y, clientHeight);
    if (dx === 0 && dy === 0) return;
    const { fits } = this;
    this.pan(dx, dy);
    // It was not the user who moved it.
    this.fits = fits;
  }

  #apply(gently: boolean): void {
    this.#content.classList.toggle("gently", gently);
    // In three dimensions, for then a browser moves it as a whole and does not paint it anew.
    this.#content.style.transform = `translate3d(${this.#x}px, ${this.#y}px, 0) scale(${this.#zoom})`;
    this.#zoomed(this.#zoom);
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const { left, top } = this.#element.getBoundingClientRect();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    // A pinch on a touchpad comes as small steps of a wheel with Ctrl.
    const pace = event.ctrlKey ? 0.01 : 0.0015;
    const factor = Math.exp(-event.deltaY * lines * pace);
    this.zoom(factor, event.clientX - left, event.clientY - top);
  }

  #down(event: PointerEvent): void {
    if (event.button !== 0) return;
    if (this.#pointers.size === 0) this.#dragged = false;
    this.#pointers.set(event.pointerId, event);
  }

  #move(event: PointerEvent): void {
    const former = this.#pointers.get(event.pointerId);
    if (former === undefined) return;
    if (event.buttons === 0) {
      this.#pointers.delete(event.pointerId);
      return;
    }
    const [dx, dy] = [event.clientX - former.clientX, event.clientY - former.clientY];
    const other = [...this.#pointers.values()].find(
      ({ pointerId }) => pointerId !== event.pointerId,
    );
    if (!this.#dragged) {
      if (Math.hypot(dx, dy) < STILL) return;
      this.#dragged = true;
      this.#element.setPointerCapture(event.pointerId);
    }
    this.#pointers.set(event.pointerId, event);
    if (other === undefined) {
      this.pan(dx, dy, false);
      return;
    }
    const { left, top } = this.#element.getBoundingClientRect();
    const far = (from: PointerEvent): number =>
      Math.hypot(from.clientX - other.clientX, from.clientY - other.clientY);
    const [x, y] = [(event.clientX + other.clientX) / 2, (event.clientY + other.clientY) / 2];
    this.pan(dx / 2, dy / 2, false);
    if (far(former) > 0) this.zoom(far(event) / far(former), x - left, y - top);
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

const limited = (zoom: number): number => Math.min(CLOSEST, Math.max(FARTHEST, zoom));
