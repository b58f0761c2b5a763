/** Parameters by their namespaces. */

export interface Leaf {
  /** The whole name: `/robot/speed`. */
  name: string;
  /** Its last part. */
  key: string;
  /** JSON text. */
  value: string;
}

export interface Namespace {
  /** The whole name; empty for the namespace of all. */
  name: string;
  key: string;
  /** Parameters in it and below it. */
  count: number;
  spaces: Map<string, Namespace>;
  leaves: Leaf[];
}

/** The tree of all parameters, by their global names, each with its JSON text. */
export function tree(parameters: Iterable<readonly [name: string, value: string]>): Namespace {
  const root = namespace("", "");
  for (const [name, value] of parameters) {
    const keys = name.split("/").filter((key) => key !== "");
    const last = keys.pop();
    if (last === undefined) continue;
    let space = root;
    space.count += 1;
    for (const key of keys) {
      let below = space.spaces.get(key);
      if (below === undefined) {
        below = namespace(`${space.name}/${key}`, key);
        space.spaces.set(key, below);
      }
      space = below;
      space.count += 1;
    }
    space.leaves.push({ name, key: last, value });
  }
  return root;
}

function namespace(name: string, key: string): Namespace {
  return { name, key, count: 0, spaces: new Map(), leaves: [] };
}
