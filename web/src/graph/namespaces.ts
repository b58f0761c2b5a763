/** Finds the namespaces that are drawn as boxes. */

export interface Named {
  id: string;
  name: string;
}

export interface Namespaces {
  /** Outer namespaces first. */
  groups: { name: string; parent: string | null }[];
  /** The innermost drawn namespace of each element that is in one. */
  of: Map<string, string>;
}

/** The namespaces of a name, innermost last: `/robot`, `/robot/arm` for `/robot/arm/camera`. */
export function enclosing(name: string): string[] {
  const found: string[] = [];
  for (let at = name.indexOf("/", 1); at !== -1; at = name.indexOf("/", at + 1)) {
    found.push(name.slice(0, at));
  }
  return found;
}

/**
 * Find the namespaces to draw: those with two or more elements.
 *
 * Of several with the same elements, only the innermost is drawn. If `wanted` is null, none are
 * drawn unless there are several namespaces.
 */
export function namespaces(elements: readonly Named[], wanted: boolean | null): Namespaces {
  const none: Namespaces = { groups: [], of: new Map() };
  if (wanted === false) return none;
  if (wanted === null && countNamespaces(elements) < 2) return none;
  const sizes = new Map<string, number>();
  for (const { name } of elements) {
    for (const space of enclosing(name)) sizes.set(space, (sizes.get(space) ?? 0) + 1);
  }
  const repeated = new Set<string>();
  for (const [space, size] of sizes) {
    for (const outer of enclosing(space)) if (sizes.get(outer) === size) repeated.add(outer);
  }
  const drawn = new Set<string>();
  for (const [space, size] of sizes) if (size > 1 && !repeated.has(space)) drawn.add(space);
  const innermost = (name: string): string | undefined =>
    enclosing(name).findLast((space) => drawn.has(space));
  const of = new Map<string, string>();
  for (const { id, name } of elements) {
    const space = innermost(name);
    if (space !== undefined) of.set(id, space);
  }
  const groups = [...drawn].sort().map((name) => ({ name, parent: innermost(name) ?? null }));
  return { groups, of };
}

export function countNamespaces(elements: readonly Named[]): number {
  return new Set(elements.map(({ name }) => enclosing(name).at(-1) ?? "/")).size;
}
