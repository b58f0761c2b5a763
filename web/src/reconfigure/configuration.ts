/**
 * The messages of dynamic_reconfigure: what a server can change, and the values that it has.
 *
 * Source: the definitions of dynamic_reconfigure/ConfigDescription, Config and ParamDescription, and
 * http://wiki.ros.org/dynamic_reconfigure.
 */
import { literalOf } from "./python_literal";

/** The type of the services by which servers are found. */
export const TYPE = "dynamic_reconfigure/Reconfigure";
/** The last part of such a service's name. */
export const SERVICE = "set_parameters";

export type Value = boolean | number | string;
export type Kind = "bool" | "int" | "double" | "str";

/** One of the values that an enumeration permits. */
export interface Choice {
  readonly name: string;
  readonly value: Value;
  readonly description: string;
}

export interface Parameter {
  readonly name: string;
  readonly kind: Kind;
  readonly description: string;
  /** The permitted values; empty if all values in the range are. */
  readonly choices: readonly Choice[];
  /** The range of a number; undefined where it has no limit. */
  readonly min: number | undefined;
  readonly max: number | undefined;
  readonly default: Value | undefined;
}

/** Parameters that are shown together, and groups within them. */
export interface Group {
  readonly id: number;
  readonly parent: number;
  readonly name: string;
  /** "" (a frame), "collapse", "hide" (the server shows and hides it), "tab" or "apply". */
  readonly type: string;
  readonly parameters: readonly Parameter[];
  readonly groups: readonly Group[];
}

/** A message of dynamic_reconfigure/Config. */
export interface Config {
  bools: { name: string; value: boolean }[];
  ints: { name: string; value: number }[];
  strs: { name: string; value: string }[];
  /** JSON has no infinity, for which the hub writes null. */
  doubles: { name: string; value: number | null }[];
  groups: { name: string; state: boolean; id: number; parent: number }[];
}

/** A message of dynamic_reconfigure/ConfigDescription. */
export interface ConfigDescription {
  groups: {
    name: string;
    type: string;
    id: number;
    parent: number;
    parameters: {
      name: string;
      type: string;
      level: number;
      description: string;
      edit_method: string;
    }[];
  }[];
  max: Config;
  min: Config;
  dflt: Config;
}

const KINDS = new Set<string>(["bool", "int", "double", "str"]);
/** The range of an int32, which generators write for parameters without limits. */
const INT_MAX = 2 ** 31 - 1;
const INT_MIN = -(2 ** 31);

/** The outermost group of a server, with all others in it; null if the description has none. */
export function groupsOf(description: ConfigDescription): Group | null {
  const max = valuesOf(description.max);
  const min = valuesOf(description.min);
  const defaults = valuesOf(description.dflt);
  const made = description.groups.map(({ id, parent, name, type, parameters }) => ({
    id,
    parent,
    name,
    type,
    groups: [] as Group[],
    parameters: parameters
      .filter((each) => KINDS.has(each.type))
      .map(
        (each): Parameter => ({
          name: each.name,
          kind: each.type as Kind,
          description: each.description,
          choices: choicesOf(each.edit_method),
          min: limitOf(min.get(each.name), INT_MIN),
          max: limitOf(max.get(each.name), INT_MAX),
          default: defaults.get(each.name),
        }),
      ),
  }));
  const root = made.find(({ id }) => id === 0) ?? made[0];
  if (root === undefined) return null;
  const byId = new Map(made.map((group) => [group.id, group]));
  for (const group of made) {
    if (group === root) continue;
    // A group whose parents do not lead to the outermost one would not be shown.
    const parent = leadsTo(group, root, byId) ? byId.get(group.parent) : root;
    (parent ?? root).groups.push(group);
  }
  return root;
}

/** The values in a configuration, by the parameters' names. */
export function valuesOf(config: Config): Map<string, Value> {
  const found = new Map<string, Value>();
  for (const { name, value } of [...config.bools, ...config.ints, ...config.strs]) {
    found.set(name, value);
  }
  for (const { name, value } of config.doubles) if (value !== null) found.set(name, value);
  return found;
}

/** Whether each group is open or shown, by their ids. */
export function statesOf(config: Config): Map<number, boolean> {
  return new Map(config.groups.map(({ id, state }) => [id, state]));
}

/** The configuration that changes some parameters and leaves the others; groups are all or none. */
export function configOf(
  values: Iterable<readonly [Parameter, Value]>,
  groups: Config["groups"] = [],
): Config {
  const config: Config = { bools: [], ints: [], strs: [], doubles: [], groups };
  for (const [{ name, kind }, value] of values) {
    if (kind === "bool") config.bools.push({ name, value: value === true });
    else if (kind === "int") config.ints.push({ name, value: Number(value) });
    else if (kind === "double") config.doubles.push({ name, value: Number(value) });
    else config.strs.push({ name, value: String(value) });
  }
  return config;
}

/** Read what a user has entered; throws an Error that says what is expected. */
export function parseValue({ kind }: Parameter, text: string): Value {
  if (kind === "str") return text;
  const number = text.trim() === "" ? Number.NaN : Number(text);
  if (kind === "int" && !(Number.isInteger(number) && number >= INT_MIN && number <= INT_MAX)) {
    throw new Error(`expected an integer of 32 bits, got “${text}”`);
  }
  if (!Number.isFinite(number)) throw new Error(`expected a number, got “${text}”`);
  return number;
}

/** The permitted values in an edit method, which is a Python dict as text. */
function choicesOf(editMethod: string): Choice[] {
  if (editMethod.trim() === "") return [];
  let method: unknown;
  try {
    method = literalOf(editMethod);
  } catch {
    return []; // The parameter is then edited as a number or text.
  }
  const choices = method instanceof Map ? method.get("enum") : undefined;
  if (!Array.isArray(choices)) return [];
  return choices.flatMap((choice) => {
    if (!(choice instanceof Map)) return [];
    const value: unknown = choice.get("value");
    if (!["boolean", "number", "string"].includes(typeof value)) return [];
    const name = String(choice.get("name") ?? value);
    return [{ name, value: value as Value, description: String(choice.get("description") ?? "") }];
  });
}

/** A limit; undefined for the values that stand for no limit: infinity, INT_MIN and INT_MAX. */
function limitOf(value: Value | undefined, extreme: number): number | undefined {
  return typeof value !== "number" || value === extreme || Math.abs(value) > 1e300
    ? undefined
    : value;
}

function leadsTo(group: Group, root: Group, byId: ReadonlyMap<number, Group>): boolean {
  let at: Group | undefined = group;
  for (let steps = 0; at !== undefined && steps <= byId.size; steps += 1) {
    if (at === root) return true;
    at = byId.get(at.parent);
  }
  return false;
}
