/** The states that a field has had: booleans, texts, and integers by the names of their constants. */
import {
  type Constant,
  kindOf,
  parsePath,
  pathText,
  type Step,
  type TypeDef,
  Types,
} from "../types";
import type { Change, Piece, Wanted } from "./sample_messages";
import type { Recorder } from "./sampler";

/** The changes that are kept; older ones are discarded, some at a time. */
const MAX_CHANGES = 20_000;
const DISCARDED = 1000;
const MAX_STATES = 1000;

export class StateTrack implements Recorder {
  /** In the order of time; no state follows the same one. */
  readonly changes: Change[] = [];
  /** The states, in the order in which they first came; those of a text may be many. */
  readonly states = new Map<string, number>();
  path: string;
  readonly #names: ReadonlyMap<bigint, string>;

  /** With types, integers are called by the names of their constants. */
  constructor(path: string, typedefs: readonly TypeDef[] = []) {
    const steps = parsePath(path) ?? [];
    this.path = pathText(steps);
    this.#names = typedefs.length === 0 ? new Map() : namesOf(new Types(typedefs), steps);
  }

  get wanted(): Wanted {
    return { kind: "states", path: this.path, names: this.#names };
  }

  take({ path, changes = [] }: Piece): void {
    this.path = path;
    for (const { time, state } of changes) this.#add(time, state);
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
}

/** The names of the values of a field, by the constants of its message. */
function namesOf(types: Types, steps: readonly Step[]): ReadonlyMap<bigint, string> {
  const fields = steps.filter((step) => typeof step === "string");
  let owner = "";
  let type = types.root;
  for (const name of fields) {
    owner = type;
    type = types.field(owner, name)?.type ?? "";
  }
  if (kindOf(type) !== "integer") return new Map();
  const all = types.constants(owner, type);
  // Some messages have constants of several fields, which begin with the field's name then.
  const prefix = `${fields.at(-1)?.toUpperCase()}_`;
  const own = all.filter(({ name }) => name.startsWith(prefix));
  const known = new Map<bigint, string>();
  for (const { name, value } of (own.length > 0 ? own : all) as Constant[]) {
    const key = BigInt(value);
    if (!known.has(key)) known.set(key, own.length > 0 ? name.slice(prefix.length) : name);
  }
  return known;
}
