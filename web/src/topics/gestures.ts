/** Moves and zooms what an element shows: by the wheel, by fingers, by the mouse with Shift, by keys. */

export interface Gestures {
  /** Move what is shown by some CSS pixels. */
  pan(dx: number, dy: number): void;
  /** Show a part of this size, around a position in CSS pixels; without one, around the centre. */
  zoom(factor: number, x?: number): void;
  reset(): void;
}

/** By how much each pixel of the wheel, and each press of a key, zooms. */
const WHEEL = 1.0015;
const KEY = 1.25;
/** The pixels of a line of the wheel, and those by which a key moves. */
const LINE = 16;
const STEP = 60;

/** Listen for gestures until the signal; keys are those of the element around, which has the focus. */
export function listen(
  element: HTMLElement,
  around: HTMLElement,
  gestures: Gestures,
  signal: AbortSignal,
): void {
  const fingers = new Map<number, PointerEvent>();
  const on = <K extends keyof HTMLElementEventMap>(
    name: K,
    listener: (event: HTMLElementEventMap[K]) => void,
  ): void => element.addEventListener(name, listener, { signal, passive: false });
  on("wheel", (event) => {
    event.preventDefault();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE : 1;
    const isAcross = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
    if (isAcross) gestures.pan(-unit * (event.deltaX || event.deltaY), 0);
    else gestures.zoom(WHEEL ** (unit * event.deltaY), offsetOf(element, event));
  });
  on("pointerdown", (event) => {
    if (!isPan(event)) return;
    event.preventDefault();
    around.focus({ preventScroll: true });
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  on("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (before === undefined) return;
    const [other] = [...fingers.values()].filter(({ pointerId }) => pointerId !== event.pointerId);
    if (other === undefined)
      gestures.pan(event.clientX - before.clientX, event.clientY - before.clientY);
    else {
      const [old, now] = [before, event].map(({ clientX }) => Math.abs(clientX - other.clientX));
      if (old && now) gestures.zoom(old / now, offsetOf(element, other));
    }
    fingers.set(event.pointerId, event);
  });
  for (const name of ["pointerup", "pointercancel"] as const) {
    on(name, ({ pointerId }) => fingers.delete(pointerId));
  }
  const press = (event: KeyboardEvent): void => {
    const work = keys(gestures)[event.key];
    if (work === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    work();
  };
  around.addEventListener("keydown", press, { signal });
}

function keys({ pan, zoom, reset }: Gestures): Record<string, () => void> {
  return {
    ArrowLeft: () => pan(STEP, 0),
    ArrowRight: () => pan(-STEP, 0),
    ArrowUp: () => pan(0, STEP),
    ArrowDown: () => pan(0, -STEP),
    "+": () => zoom(1 / KEY),
    "=": () => zoom(1 / KEY),
    "-": () => zoom(KEY),
    Escape: reset,
    Home: reset,
  };
}

function isPan({ pointerType, button, shiftKey }: PointerEvent): boolean {
  return pointerType === "touch" || button === 1 || (button === 0 && shiftKey);
}

function offsetOf(element: HTMLElement, { clientX }: MouseEvent): number {
  return clientX - element.getBoundingClientRect().left;
}
