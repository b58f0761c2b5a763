/** Take what is plotted out of messages, in the worker. */
import { resolve, valueAt } from "../element_names";
import { numberText, secondsOf } from "../messages/values";
import { parsePath, pathText, type Step } from "../types";
import { ABSENT, Expression, WAITING } from "./expression";
import { exactParts, GAP } from "./ring_buffer";
import type { Change, Piece, Wanted } from "./sample_messages";

/** The longest text of a state, in characters. */
const MAX_TEXT = 200;

export interface FieldReader {
  readonly path: string;
  /** Take something of a message. Returns whether it should have had something, but has not. */
  read(message: unknown, time: number): boolean;
  /** The next message does not follow those before. */
  reset(): void;
  /** Forget what was read: the next message is of another run. */
  clear(): void;
  /** What was read since the last call; `undefined` if that is nothing. */
  take(): Piece | undefined;
}

/** Throws an `ExpressionError` if the text of a curve is invalid. */
export function readerOf(wanted: Wanted): FieldReader {
  return wanted.kind === "curve" ? new CurveReader(wanted.text) : new StateReader(wanted);
}

class CurveReader implements FieldReader {
  readonly #expression: Expression;
  #samples: number[] = [];
  #rests: number[] = [];
  #isExact = true;
  #elements: Float64Array | undefined;
  #isEmpty = true;
  #isNew = false;

  constructor(text: string) {
    this.#expression = new Expression(text);
  }

  get path(): string {
    return this.#expression.text;
  }

  read(message: unknown, time: number): boolean {
    const value = this.#expression.evaluate(message, time);
    // Messages of other nodes have other elements: they leave no gap.
    if (value === ABSENT) return this.#isEmpty;
    if (value === WAITING) return false;
    if (value === undefined) {
      this.#expression.reset();
      if (!this.#expression.isArray) this.#add(time, GAP, GAP);
      return true;
    }
    if (typeof value === "object") this.#elements = value;
    else this.#add(time, ...exactParts(value));
    return false;
  }

  reset(): void {
    this.#expression.reset();
  }

  clear(): void {
    this.take();
    this.#expression.reset();
    this.#isEmpty = true;
    this.#isNew = true;
  }

  take(): Piece | undefined {
    const [samples, elements, isNew] = [this.#samples, this.#elements, this.#isNew];
    if (samples.length === 0 && elements === undefined && !isNew) return undefined;
    const rests = this.#isExact ? undefined : Float64Array.from(this.#rests);
    this.#samples = [];
    this.#rests = [];
    this.#isExact = true;
    this.#elements = undefined;
    this.#isNew = false;
    return { path: this.path, isNew, samples: Float64Array.from(samples), rests, elements };
  }

  #add(time: number, value: number, rest: number): void {
    this.#isEmpty = false;
    this.#samples.push(time, value);
    this.#rests.push(rest);
    if (!Object.is(rest, 0)) this.#isExact = false;
  }
}

class StateReader implements FieldReader {
  readonly #nameOf: (value: bigint) => string | undefined;
  #steps: readonly Step[];
  #changes: Change[] = [];
  #last: string | undefined;
  #isEmpty = true;
  #isNew = false;

  constructor({ path, names }: Wanted & { kind: "states" }) {
    this.#steps = parsePath(path) ?? [];
    this.#nameOf = (value) => names.get(value);
  }

  get path(): string {
    return pathText(this.#steps);
  }

  read(message: unknown, time: number): boolean {
    const found = resolve(message, this.#steps);
    // Messages of other nodes have other elements.
    if (found === undefined) return this.#isEmpty;
    const state = this.#stateOf(valueAt(message, found.indices));
    if (state !== undefined) this.#steps = found.named;
    if (this.#isEmpty || state !== this.#last) this.#changes.push({ time, state });
    this.#last = state;
    this.#isEmpty = false;
    return state === undefined;
  }

  reset(): void {
    this.#isEmpty = true;
  }

  clear(): void {
    this.#changes = [];
    this.#isEmpty = true;
    this.#isNew = true;
  }

  take(): Piece | undefined {
    const [changes, isNew] = [this.#changes, this.#isNew];
    if (changes.length === 0 && !isNew) return undefined;
    this.#changes = [];
    this.#isNew = false;
    return { path: this.path, isNew, changes };
  }

  #stateOf(value: unknown): string | undefined {
    if (typeof value === "string") return value.slice(0, MAX_TEXT);
    if (typeof value === "boolean") return String(value);
    if (typeof value === "bigint") return this.#nameOf(value) ?? String(value);
    if (typeof value === "number") {
      const name = Number.isInteger(value) ? this.#nameOf(BigInt(value)) : undefined;
      return name ?? numberText(value);
    }
    const seconds = secondsOf(value);
    return seconds === undefined ? undefined : `${seconds} s`;
  }
}
