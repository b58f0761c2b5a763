/**
 * What is sent to a robot while somebody drives it.
 *
 * Velocities are sent again and again while anything is held, then one zero, then nothing: zeros at
 * rest would fight against other publishers.
 */

/** Parts of the limits, -1 to 1: forwards, to the left, and turning to the left (REP 103). */
export interface Direction {
  readonly forward: number;
  readonly left: number;
  readonly turn: number;
}

/** In meters and radians per second. */
export type Velocity = Direction;

export interface Limits {
  /** In m/s; also sideways. */
  readonly speed: number;
  /** In rad/s. */
  readonly turn: number;
  /** Seconds from rest to the limit; slowing down takes none. */
  readonly ramp: number;
}

/** Time between two messages, in ms. */
export const INTERVAL = 50;
/** How often a stop is sent. */
const STOPS = 3;

const NOTHING: Direction = { forward: 0, left: 0, turn: 0 };
const PARTS = ["forward", "left", "turn"] as const;

export interface Output {
  /** The first message is about to be sent: somebody has begun to drive. */
  begin(): void;
  send(velocity: Velocity): void;
  /** The last message has been sent. */
  end(): void;
}

export class Drive {
  limits: Limits;
  readonly #output: Output;
  /** What is held, by its kind: a stick, keys, a gamepad. */
  readonly #held = new Map<string, Direction>();
  #current = NOTHING;
  #timer: ReturnType<typeof setInterval> | undefined;
  #stopped = false;

  constructor(limits: Limits, output: Output) {
    this.limits = limits;
    this.#output = output;
  }

  get isDriving(): boolean {
    return this.#timer !== undefined;
  }

  /** Whether nothing moves until `resume`. */
  get isStopped(): boolean {
    return this.#stopped;
  }

  /** The velocity that was sent last. */
  get velocity(): Velocity {
    return this.#current;
  }

  /** Hold something in a direction; nothing happens while stopped. */
  hold(kind: string, direction: Direction): void {
    if (this.#stopped) return;
    this.#held.set(kind, direction);
    if (this.isDriving) return;
    this.#output.begin();
    this.#timer = setInterval(() => this.#tick(), INTERVAL);
    this.#tick();
  }

  /** Release something; the last one sends zero at once. */
  release(kind: string): void {
    this.#held.delete(kind);
    if (this.#held.size === 0) this.releaseAll();
  }

  /** Release everything, as when the window loses the focus or the connection. */
  releaseAll(): void {
    this.#held.clear();
    if (!this.isDriving) return;
    clearInterval(this.#timer);
    this.#timer = undefined;
    this.#current = NOTHING;
    this.#output.send(NOTHING);
    this.#output.end();
  }

  /** Send zeros, also if nothing is held, and ignore what is held until `resume`. */
  stop(): void {
    const wasDriving = this.isDriving;
    if (!wasDriving) this.#output.begin();
    this.#stopped = true;
    this.#held.clear();
    clearInterval(this.#timer);
    this.#timer = undefined;
    this.#current = NOTHING;
    for (let count = 0; count < STOPS; count += 1) this.#output.send(NOTHING);
    this.#output.end();
  }

  /** Drive again after a stop. */
  resume(): void {
    this.#stopped = false;
  }

  #tick(): void {
    const { speed, turn, ramp } = this.limits;
    const next = { ...NOTHING };
    for (const part of PARTS) {
      const limit = part === "turn" ? turn : speed;
      const wanted = limit * clamp(this.#sum(part));
      const step = ramp === 0 ? limit : (limit * INTERVAL) / 1000 / ramp;
      next[part] = ramped(this.#current[part], wanted, step);
    }
    this.#current = next;
    this.#output.send(next);
  }

  #sum(part: (typeof PARTS)[number]): number {
    let sum = 0;
    for (const direction of this.#held.values()) sum += direction[part];
    return sum;
  }
}

function clamp(part: number): number {
  return Math.max(-1, Math.min(1, part));
}

/** Come nearer to a velocity, by one step at most unless that is slower. */
function ramped(current: number, wanted: number, step: number): number {
  // In the other direction, it begins at rest.
  const from = Math.sign(current) === Math.sign(wanted) ? Math.abs(current) : 0;
  return Math.sign(wanted) * Math.min(Math.abs(wanted), from + step);
}

/** The directions of keys, by their codes, so that the layout of the keyboard does not matter. */
const KEYS: Readonly<Record<string, Partial<Direction>>> = {
  ArrowUp: { forward: 1 },
  KeyW: { forward: 1 },
  ArrowDown: { forward: -1 },
  KeyS: { forward: -1 },
  ArrowLeft: { turn: 1 },
  KeyA: { turn: 1 },
  ArrowRight: { turn: -1 },
  KeyD: { turn: -1 },
  KeyQ: { left: 1 },
  KeyE: { left: -1 },
};

/** The direction of a key; undefined for others. */
export function directionOf(code: string): Direction | undefined {
  const found = KEYS[code];
  return found && { ...NOTHING, ...found };
}

/** The dead zone in the middle of a gamepad's stick. */
const DEAD = 0.1;
/** The axes of the standard gamepad: https://w3c.github.io/gamepad/#remapping. */
const [LEFT_X, LEFT_Y, RIGHT_X] = [0, 1, 2];
/** Its shoulder buttons, of which one must be held. */
const HOLD = [4, 5];

/** The direction of a gamepad, or undefined while no shoulder button is held. */
export function directionOfGamepad({
  axes,
  buttons,
}: Pick<Gamepad, "axes" | "buttons">): Direction | undefined {
  if (!HOLD.some((button) => buttons[button]?.pressed)) return undefined;
  const axis = (number: number): number => {
    const value = axes[number] ?? 0;
    const size = Math.max(0, Math.abs(value) - DEAD) / (1 - DEAD);
    return size === 0 ? 0 : -Math.sign(value) * size;
  };
  return { forward: axis(LEFT_Y), left: axis(LEFT_X), turn: axis(RIGHT_X) };
}

/** The direction of a stick that is `x` to the right of its middle and `y` below it, -1 to 1. */
export function directionOfStick(x: number, y: number, sideways: boolean): Direction {
  const size = Math.max(1, Math.hypot(x, y));
  const [right, down] = [x / size, y / size];
  return sideways
    ? { forward: -down || 0, left: -right || 0, turn: 0 }
    : { forward: -down || 0, left: 0, turn: -right || 0 };
}
