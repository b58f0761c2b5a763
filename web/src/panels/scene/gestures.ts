/** Mouse, fingers and keys on the picture: they move the camera, or use a tool. */
import type { Camera } from "./camera";
import type { Pointer } from "./layer";

/** A factor of the distance to the camera, for a step of the wheel or a key. */
const ZOOM = 1.15;
/** A press that moves less is a click, in pixels. */
const CLICK = 4;
/** Pixels for a press of an arrow key. */
const STEP = 24;

/** Where the pointer is, and whether it is a finger. */
export interface Press extends Pointer {
  readonly isTouch: boolean;
}

export interface GestureTarget {
  readonly camera: Camera;
  /** The camera has moved. */
  moved(): void;
  /** Whether a tool takes what the first button or finger does. */
  readonly hasTool: boolean;
  pressed(at: Press): void;
  dragged(at: Press): void;
  released(at: Press): void;
  /** The press ended without a release, such as by a second finger. */
  cancelled(): void;
  /** A click without a tool. */
  clicked(at: Pointer): void;
  /** The pointer is above the picture; `undefined` when it has left. */
  hovered(at: Pointer | undefined): void;
}

export class Gestures {
  readonly #stage: HTMLElement;
  readonly #target: GestureTarget;
  /** Where each pressed pointer was last. */
  readonly #pointers = new Map<number, Pointer>();
  /** Whether the press belongs to the tool. */
  #isTool = false;
  /** Where a press began that may be a click. */
  #start: Pointer | undefined;

  constructor(stage: HTMLElement, target: GestureTarget) {
    this.#stage = stage;
    this.#target = target;
    stage.addEventListener("pointerdown", (event) => this.#down(event));
    stage.addEventListener("pointermove", (event) => this.#move(event));
    stage.addEventListener("pointerup", (event) => this.#up(event, true));
    stage.addEventListener("pointercancel", (event) => this.#up(event, false));
    stage.addEventListener("pointerleave", () => target.hovered(undefined));
    stage.addEventListener("contextmenu", (event) => event.preventDefault());
    stage.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
  }

  #place({ clientX, clientY }: MouseEvent): Pointer {
    const box = this.#stage.getBoundingClientRect();
    return { x: clientX - box.left, y: clientY - box.top };
  }

  #press(event: PointerEvent): Press {
    return { ...this.#place(event), isTouch: event.pointerType !== "mouse" };
  }

  #down(event: PointerEvent): void {
    this.#stage.focus({ preventScroll: true });
    this.#stage.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, this.#place(event));
    this.#start = this.#pointers.size === 1 ? this.#place(event) : undefined;
    if (this.#pointers.size > 1) {
      if (this.#isTool) this.#target.cancelled();
      this.#isTool = false;
      return;
    }
    this.#isTool = this.#target.hasTool && event.button === 0;
    if (this.#isTool) this.#target.pressed(this.#press(event));
    event.preventDefault();
  }

  #move(event: PointerEvent): void {
    const now = this.#place(event);
    const before = this.#pointers.get(event.pointerId);
    if (before === undefined) {
      this.#target.hovered(now);
      return;
    }
    const others = [...this.#pointers].filter(([id]) => id !== event.pointerId);
    this.#pointers.set(event.pointerId, now);
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    const other = others[0]?.[1];
    if (other !== undefined) this.#pinch(before, now, other);
    else if (this.#isTool) this.#target.dragged(this.#press(event));
    else this.#drag(event, dx, dy);
  }

  #drag({ buttons, shiftKey }: PointerEvent, dx: number, dy: number): void {
    const { camera } = this.#target;
    const isSecond = shiftKey || (buttons & 1) === 0;
    if (isSecond === (camera.mode === "orbit")) camera.pan(dx, dy);
    else camera.turn(dx, dy);
    this.#target.moved();
  }

  /** Two fingers move the picture, and turn it if one looks from above. */
  #pinch(before: Pointer, now: Pointer, other: Pointer): void {
    const { camera } = this.#target;
    const distance = (at: Pointer): number => Math.hypot(at.x - other.x, at.y - other.y);
    const angle = (at: Pointer): number => Math.atan2(at.y - other.y, at.x - other.x);
    // Each of the two fingers moves the middle by half.
    camera.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
    const factor = distance(before) / Math.max(1, distance(now));
    camera.zoom(factor, (now.x + other.x) / 2, (now.y + other.y) / 2);
    if (camera.mode === "top") camera.spin(angle(now) - angle(before));
    this.#target.moved();
  }

  #up(event: PointerEvent, isRelease: boolean): void {
    if (!this.#pointers.delete(event.pointerId)) return;
    if (!this.#isTool) {
      const { x, y } = this.#place(event);
      const start = isRelease ? this.#start : undefined;
      this.#start = undefined;
      if (start && Math.hypot(x - start.x, y - start.y) < CLICK) this.#target.clicked({ x, y });
      return;
    }
    this.#isTool = false;
    if (isRelease) this.#target.released(this.#press(event));
    else this.#target.cancelled();
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const { x, y } = this.#place(event);
    // Lines and pages are a step; a touchpad has smaller ones.
    const pixels = event.deltaMode === 0 ? event.deltaY : 100 * Math.sign(event.deltaY);
    const steps = Math.max(-3, Math.min(3, pixels / 100));
    this.#target.camera.zoom(ZOOM ** (event.ctrlKey ? 4 * steps : steps), x, y);
    this.#target.moved();
  }
}

/** Move the camera by a key; returns whether there is such a key. */
export function moveByKey(camera: Camera, { key, shiftKey }: KeyboardEvent): boolean {
  const steps: Readonly<Record<string, readonly [number, number]>> = {
    ArrowLeft: [STEP, 0],
    ArrowRight: [-STEP, 0],
    ArrowUp: [0, STEP],
    ArrowDown: [0, -STEP],
  };
  const step = steps[key];
  if (step !== undefined) {
    if (shiftKey === (camera.mode === "orbit")) camera.pan(...step);
    else camera.turn(-step[0], -step[1]);
  } else if (key === "+" || key === "=") {
    camera.zoom(1 / ZOOM);
  } else if (key === "-") {
    camera.zoom(ZOOM);
  } else {
    return false;
  }
  return true;
}
