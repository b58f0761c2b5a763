/** Message types as rosapi describes them: fields, ranges, constants, and paths to numbers. */

/** A rosapi/TypeDef. Lists of them begin with the requested type. */
export interface TypeDef {
  type: string;
  fieldnames: string[];
  /** Full names, without the brackets of arrays. */
  fieldtypes: string[];
  /** -1: not an array, 0: an array of any length, n: an array of n elements. */
  fieldarraylen: number[];
  examples: string[];
  constnames: string[];
  constvalues: string[];
}

export interface Field {
  readonly name: string;
  readonly type: string;
  /** -1: not an array, 0: an array of any length, n: an array of n elements. */
  readonly array: number;
}

export interface Constant {
  readonly name: string;
  readonly value: string;
}

export type Kind = "integer" | "float" | "bool" | "string" | "time" | "duration" | "message";

const INTEGERS = new Map<string, readonly [low: bigint, high: bigint]>([
  ...[8n, 16n, 32n, 64n].flatMap((bits): [string, readonly [bigint, bigint]][] => [
    [`int${bits}`, [-(1n << (bits - 1n)), (1n << (bits - 1n)) - 1n]],
    [`uint${bits}`, [0n, (1n << bits) - 1n]],
  ]),
  ["byte", [-128n, 127n]],
  ["char", [0n, 255n]],
]);

/** The kind of value that a type has. */
export function kindOf(type: string): Kind {
  if (INTEGERS.has(type)) return "integer";
  if (type === "float32" || type === "float64") return "float";
  if (type === "string" || type === "wstring") return "string";
  if (type === "bool" || type === "time" || type === "duration") return type;
  return "message";
}

/** The smallest and the largest value of an integer type. */
export function rangeOf(type: string): readonly [low: bigint, high: bigint] | undefined {
  return INTEGERS.get(type);
}

/** Whether a field is a byte string, which is base64 in JSON. */
export function isBytes(field: Field): boolean {
  return field.array >= 0 && (field.type === "uint8" || field.type === "char");
}

/** A field's type as .msg files write it: `float64[36]`. */
export function typeText(field: Field): string {
  if (field.array < 0) return field.type;
  return `${field.type}[${field.array === 0 ? "" : field.array}]`;
}

/** A type with all types in it. */
export class Types {
  readonly root: string;
  readonly #fields = new Map<string, Field[]>();
  readonly #constants = new Map<string, Constant[]>();

  constructor(typedefs: readonly TypeDef[]) {
    this.root = typedefs[0]?.type ?? "";
    for (const def of typedefs) {
      this.#fields.set(
        def.type,
        def.fieldnames.map((name, at) => ({
          name,
          type: def.fieldtypes[at] ?? "",
          array: def.fieldarraylen[at] ?? -1,
        })),
      );
      this.#constants.set(
        def.type,
        def.constnames.map((name, at) => ({ name, value: def.constvalues[at] ?? "" })),
      );
    }
  }

  /** The fields of a message type; empty for other types and for unknown ones. */
  fields(type: string): readonly Field[] {
    return kindOf(type) === "message" ? (this.#fields.get(type) ?? []) : [];
  }

  field(type: string, name: string): Field | undefined {
    return this.fields(type).find((field) => field.name === name);
  }

  /** The constants of a message that fit a field of an integer or string type. */
  constants(message: string, type: string): readonly Constant[] {
    const all = this.#constants.get(message) ?? [];
    const range = rangeOf(type);
    if (range === undefined) {
      return kindOf(type) === "string" ? all.filter(({ value }) => !/^-?[\d.]+$/.test(value)) : [];
    }
    return all.filter(({ value }) => {
      if (!/^-?\d+$/.test(value)) return false;
      const number = BigInt(value);
      return range[0] <= number && number <= range[1];
    });
  }

  /**
   * The paths of all plottable values in a message: `pose.position.x`.
   *
   * Of an array of any length, only the first element: `ranges[0]`. Times count as seconds,
   * booleans as 0 and 1.
   */
  numberPaths(limit = 500): string[] {
    return this.#paths((field) => kindOf(field.type) !== "string", limit);
  }

  /** The paths of all values that are states: booleans, integers and texts; those with constants first. */
  statePaths(limit = 500): string[] {
    const named: string[] = [];
    const paths = this.#paths((field, path, owner) => {
      const isState = ["bool", "integer", "string"].includes(kindOf(field.type));
      const hasNames = isState && this.constants(owner, field.type).length > 0;
      if (field.type === "bool" || hasNames) named.push(path);
      return isState;
    }, limit).filter((path) => !this.#isHeader(path));
    return [...new Set([...named, ...paths])];
  }

  /** The paths of the values in a message that are wanted, which are not messages. */
  #paths(
    isWanted: (field: Field, path: string, owner: string) => boolean,
    limit: number,
  ): string[] {
    const paths: string[] = [];
    const visit = (type: string, parent: string): void => {
      for (const field of this.fields(type)) {
        if (paths.length >= limit) return;
        const path = parent === "" ? field.name : `${parent}.${field.name}`;
        const isMessage = kindOf(field.type) === "message";
        const elements = field.array < 0 ? [path] : elementPaths(path, field.array, limit);
        for (const each of elements) {
          if (isMessage) visit(field.type, each);
          else if (paths.length < limit && isWanted(field, each, type)) paths.push(each);
        }
      }
    };
    visit(this.root, "");
    return paths;
  }

  /** The paths that the button "Plot" adds: all if there are at most three, else the first. */
  plotPaths(): string[] {
    const paths = this.numberPaths().filter((path) => !this.#isHeader(path));
    return paths.length <= 3 ? paths : paths.slice(0, 1);
  }

  #isHeader(path: string): boolean {
    const first = path.split(".")[0] ?? "";
    return this.field(this.root, first)?.type === "std_msgs/Header";
  }
}

function elementPaths(path: string, length: number, limit: number): string[] {
  const count = length === 0 ? 1 : Math.min(length, limit);
  return Array.from({ length: count }, (_, index) => `${path}[${index}]`);
}

/** A step of a path to a value: a field, an index of an array, or the name of an element. */
export type Step = string | number | { readonly name: string };

/**
 * Parse a path: `poses[3].x` is `["poses", 3, "x"]`, `position[elbow]` has an element's name.
 *
 * Returns `undefined` if it is invalid.
 */
export function parsePath(path: string): Step[] | undefined {
  const steps: Step[] = [];
  const part = /([A-Za-z_]\w*)((?:\[[^[\]]+\])*)(?:\.(?=[A-Za-z_])|$)/y;
  const text = path.trim();
  do {
    const found = part.exec(text);
    if (found === null) return undefined;
    steps.push(found[1] ?? "");
    for (const [, element = ""] of (found[2] ?? "").matchAll(/\[([^\]]+)\]/g))
      steps.push(/^\d+$/.test(element) ? Number(element) : { name: element });
  } while (part.lastIndex < text.length);
  return steps;
}

/** A path as text. */
export function pathText(steps: readonly Step[]): string {
  return steps.reduce<string>((text, step) => {
    if (typeof step === "number") return `${text}[${step}]`;
    if (typeof step === "object") return `${text}[${step.name}]`;
    return text === "" ? step : `${text}.${step}`;
  }, "");
}

/** An own property of an object: a field may be called `__proto__` or `constructor`. */
export function own(value: unknown, name: string): unknown {
  if (typeof value !== "object" || value === null || !Object.hasOwn(value, name)) return undefined;
  return (value as Record<string, unknown>)[name];
}

/** Decode base64 text; `undefined` if it is invalid. */
export function bytesOf(base64: string): Uint8Array | undefined {
  try {
    return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  } catch {
    return undefined;
  }
}

/** The number of bytes that base64 text encodes. */
export function byteLength(base64: string): number {
  const padding = /=*$/.exec(base64.slice(-2))?.[0].length ?? 0;
  return Math.max(0, Math.floor(base64.length / 4) * 3 - padding);
}
