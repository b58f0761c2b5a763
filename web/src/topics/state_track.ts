/** The states that a field has had: booleans, texts, and integers by the names of their constants. */
import { resolve, valueAt } from "../element_names";
import type { Message } from "../hub";
import { numberText, secondsOf } from "../messages/values";
import { type Constant, kindOf, parsePath, pathText, type Step, type Types } from "../types";
import type { Recorder } from "./sampler";

/** From a time on, in seconds, the field had this state; `undefined` is a time without messages. */
export interface Change {
  readonly time: number;
  readonly state: string | undefined;
}

/** The changes that are kept; older ones are discarded, some at a time. */
const MAX_CHANGES = 20_000;
const DISCARDED = 1000;
const MAX_STATES = 1000;
/** The longest text of a state, in characters. */
const MAX_TEXT = 200;

export class StateTrack implements Recorder {
  /** In the order of time; no state follows the same one. */
  readonly changes: Change[] = [];
  /** The states, in the order in which they first came; those of a text may be many. */
  readonly states = new Map<string, number>();
  readonly #nameOf: (value: bigint) => string | undefined;
  #steps: readonly Step[];

  /** With types, integers are called by the names of their constants. */
  constructor(path: string, types?: Types) {
    this.#steps = parsePath(path) ?? [];
    this.#nameOf = types === undefined ? () => undefined : namesOf(types, this.#steps);
  }

  get path(): string {
    return pathText(this.#steps);
  }

  record(message: Message, time: number): boolean {
    const found = resolve(message, this.#steps);
    // Messages of other nodes have other elements.
    if (found === undefined) return this.changes.length === 0;
    const state = this.#stateOf(valueAt(message, found.indices));
    if (state !== undefined) this.#steps = found.named;
    this.#add(time, state);
    return state === undefined;
  }

  pause(time: number): void {
    if (this.changes.length > 0) this.#add(time, undefined);
  }

  clear(): void {
    this.changes.length = 0;
    this.states.clear();
  }

  get newest(): string | undefined {
    return this.changes.at(-1)?.state;
  }

  /** The index of the change that made the state of a time; -1 if there was none before. */
  indexAt(time: number): number {
    let low = 0;
    let high = this.changes.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if ((this.changes[middle] as Change).time <= time) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  at(time: number): string | undefined {
    return this.changes[this.indexAt(time)]?.state;
  }

  #add(time: number, state: string | undefined): void {
    const last = this.changes.at(-1);
    if (last !== undefined && last.state === state) return;
    const isNew = state !== undefined && !this.states.has(state);
    if (isNew && this.states.size < MAX_STATES) this.states.set(state, this.states.size);
    // Times never decrease.
    this.changes.push({ time: Math.max(time, last?.time ?? -Infinity), state });
    if (this.changes.length > MAX_CHANGES) this.changes.splice(0, DISCARDED);
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

/** The names of the values of a field, by the constants of its message. */
function namesOf(types: Types, steps: readonly Step[]): (value: bigint) => string | undefined {
  const fields = steps.filter((step) => typeof step === "string");
  let owner = "";
  let type = types.root;
  for (const name of fields) {
    owner = type;
    type = types.field(owner, name)?.type ?? "";
  }
  if (kindOf(type) !== "integer") return () => undefined;
  const all = types.constants(owner, type);
  // Some messages have constants of several fields, which begin with the field's name then.
  const prefix = `${fields.at(-1)?.toUpperCase()}_`;
  const own = all.filter(({ name }) => name.startsWith(prefix));
  const known = new Map<bigint, string>();
  for (const { name, value } of (own.length > 0 ? own : all) as Constant[]) {
    const key = BigInt(value);
    if (!known.has(key)) known.set(key, own.length > 0 ? name.slice(prefix.length) : name);
  }
  return (value) => known.get(value);
}
