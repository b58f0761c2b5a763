/** The names of array elements: a joint's position is `position[elbow]` instead of `position[3]`. */
import { elements } from "./messages/values";
import { own, parsePath, pathText, type Step } from "./types";

/** Fields that name an element of an array of messages, such as KeyValue or TransformStamped. */
const OWN_NAMES = ["name", "key", "label", "child_frame_id"];
/** Arrays of names, for the arrays beside them that are as long, as in JointState and LinkStates. */
const PARALLEL = ["name", "names", "joint_names"];
/** Those that also name the elements of messages within, as in JointTrajectory. */
const INHERITED = ["joint_names"];

/**
 * The names of the elements of an array; `undefined` if they have none.
 *
 * `key` is the array's field, `owners` are the messages that it is in, innermost first. Names that
 * are numbers, or that several elements have, are left out.
 */
export function elementNames(
  array: ArrayLike<unknown>,
  key: string,
  owners: readonly unknown[],
): (string | undefined)[] | undefined {
  const names = ownNames(array) ?? parallelNames(array, key, owners);
  if (names === undefined) return undefined;
  const counts = new Map<string, number>();
  for (const name of names) counts.set(name, (counts.get(name) ?? 0) + 1);
  return names.map((name) =>
    counts.get(name) === 1 && /^(?!\d+$)[^[\]]+$/.test(name) ? name : undefined,
  );
}

function ownNames(array: ArrayLike<unknown>): string[] | undefined {
  const field = OWN_NAMES.find((each) => typeof own(array[0], each) === "string");
  return field === undefined
    ? undefined
    : Array.from(array, (element) => String(own(element, field)));
}

function parallelNames(
  array: ArrayLike<unknown>,
  key: string,
  owners: readonly unknown[],
): string[] | undefined {
  // A trajectory has as many points as it likes: each is for all joints.
  if (PARALLEL.includes(key) || key === "points") return undefined;
  for (const [depth, owner] of owners.entries()) {
    for (const field of depth === 0 ? PARALLEL : INHERITED) {
      const names = own(owner, field);
      if (!Array.isArray(names) || names.length !== array.length) continue;
      if (names.every((name) => typeof name === "string")) return names;
    }
  }
  return undefined;
}

/**
 * A path with the indices that named elements have in a message, and with names instead of indices.
 *
 * Returns `undefined` if the message has no element of such a name: several nodes may publish the
 * states of different joints.
 */
export function resolve(
  message: unknown,
  steps: readonly Step[],
): { readonly indices: (string | number)[]; readonly named: Step[] } | undefined {
  let value = message;
  let key = "";
  const owners: unknown[] = [];
  const indices: (string | number)[] = [];
  const named: Step[] = [];
  for (const step of steps) {
    if (typeof step === "string") {
      owners.unshift(value);
      key = step;
      value = own(value, step);
      indices.push(step);
      named.push(step);
      continue;
    }
    const array = elements(value) ?? [];
    const names = elementNames(array, key, owners);
    const index = typeof step === "number" ? step : (names?.indexOf(step.name) ?? -1);
    if (index < 0) return undefined;
    value = array[index];
    indices.push(index);
    const name = names?.[index];
    named.push(name === undefined ? step : { name });
  }
  return { indices, named };
}

/** The paths of all named elements that a path with indices stands for: `position[elbow]`. */
export function expand(message: unknown, path: string): string[] {
  const steps = parsePath(path) ?? [];
  const at = steps.findIndex((step, index) => {
    if (typeof step !== "number") return false;
    const found = resolve(message, steps.slice(0, index + 1));
    return typeof found?.named[index] === "object";
  });
  if (at < 0) return [path];
  const array = valueAt(message, resolve(message, steps.slice(0, at))?.indices ?? []);
  return Array.from(elements(array) ?? []).flatMap((_, index) => {
    const start = resolve(message, [...steps.slice(0, at), index])?.named ?? [];
    return expand(message, pathText([...start, ...steps.slice(at + 1)]));
  });
}

/** The value at a path with indices. */
export function valueAt(message: unknown, path: readonly (string | number)[]): unknown {
  return path.reduce<unknown>((value, step) => own(value, String(step)), message);
}
