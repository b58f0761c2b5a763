/** Parameters: the services of rosapi for them, their namespaces, and their values as text. */
import type { DataSource } from "../source";

/** The value in the response if there are no parameters at all. */
const MISSING = "{}";

export class ParameterServer {
  readonly #hub: DataSource;

  constructor(hub: DataSource) {
    this.#hub = hub;
  }

  /** All parameters as one JSON text. */
  all(): Promise<string> {
    return this.get("/", MISSING);
  }

  /** A parameter or a namespace as JSON text; another text if it is not set. */
  async get(name: string, otherwise: string): Promise<string> {
    const request = { name, default: otherwise };
    return (await this.#call<{ value: string }>("get_param", "GetParam", request)).value;
  }

  async set(name: string, value: string): Promise<void> {
    await this.#call("set_param", "SetParam", { name, value });
  }

  async remove(name: string): Promise<void> {
    await this.#call("delete_param", "DeleteParam", { name });
  }

  #call<T>(service: string, type: string, request: Record<string, string>): Promise<T> {
    return this.#hub.call<T>(`/rosapi/${service}`, `rosapi/${type}`, request);
  }
}

/** A string, a bracket, a separator, or any other value. */
const TOKEN = /\s*("(?:[^"\\]|\\.)*"|[[\]{},:]|[^\s[\]{},:"]+)/y;

/**
 * Split the JSON text of a namespace into parameters, sorted by name, each with its JSON text.
 *
 * Empty namespaces are left out. Values are not parsed: numbers keep all their digits, and 1.0
 * stays different from 1.
 */
export function splitParameters(json: string): [name: string, value: string][] {
  const found: [name: string, value: string][] = [];
  let end = 0;
  const next = (): string => {
    TOKEN.lastIndex = end;
    const token = TOKEN.exec(json)?.[1];
    if (token === undefined) throw new SyntaxError("the hub sent invalid JSON");
    end = TOKEN.lastIndex;
    return token;
  };
  const skipList = (): void => {
    for (let depth = 1; depth > 0; ) {
      const token = next();
      if (token === "[" || token === "{") depth += 1;
      if (token === "]" || token === "}") depth -= 1;
    }
  };
  const split = (name: string): void => {
    const first = next();
    if (first !== "{") {
      const start = end - first.length;
      if (first === "[") skipList();
      found.push([name, json.slice(start, end)]);
      return;
    }
    for (let token = next(); token !== "}"; token = next()) {
      if (token === ",") continue;
      next();
      split(`${name}/${JSON.parse(token) as string}`);
    }
  };
  split("");
  return found.sort(([one], [other]) => (one < other ? -1 : 1));
}

/** A parameter in its namespace. */
export interface Parameter {
  /** The full name: `/robot/speed`. */
  name: string;
  /** The last part of the name. */
  key: string;
  /** JSON text. */
  value: string;
}

export interface Namespace {
  /** The full name; empty for the root. */
  name: string;
  key: string;
  /** The number of parameters in it and below it. */
  count: number;
  children: Map<string, Namespace>;
  parameters: Parameter[];
}

/** Arrange parameters, given by global names and JSON texts, by their namespaces. */
export function parameterTree(
  parameters: Iterable<readonly [name: string, value: string]>,
): Namespace {
  const root = namespace("", "");
  for (const [name, value] of parameters) {
    const keys = name.split("/").filter((key) => key !== "");
    const last = keys.pop();
    if (last === undefined) continue;
    let space = root;
    space.count += 1;
    for (const key of keys) {
      let below = space.children.get(key);
      if (below === undefined) {
        below = namespace(`${space.name}/${key}`, key);
        space.children.set(key, below);
      }
      space = below;
      space.count += 1;
    }
    space.parameters.push({ name, key: last, value });
  }
  return root;
}

function namespace(name: string, key: string): Namespace {
  return { name, key, count: 0, children: new Map(), parameters: [] };
}

/** The kind of a JSON value, in words. */
export function kind(json: string): string {
  const value = parsed(json);
  switch (typeof value) {
    case "string":
      return "text";
    case "boolean":
      return "true or false";
    case "number":
      // ROS distinguishes 1.0 from 1, JSON.parse does not.
      return /^-?\d+$/.test(json.trim()) ? "integer" : "number";
    case "object":
      if (value === null) return "null";
      return Array.isArray(value) ? "list" : "object";
    default:
      return "text";
  }
}

/** A value as text to edit: JSON, but strings without quotes where that is unambiguous. */
export function toText(json: string): string {
  const value = parsed(json);
  const plain =
    typeof value === "string" && value !== "" && fromText(value) === JSON.stringify(value);
  return plain ? value : json;
}

/** The JSON of edited text: text that is not valid JSON is a string. */
export function fromText(text: string): string {
  const trimmed = text.trim();
  return parsed(trimmed) === undefined ? JSON.stringify(visible(text)) : trimmed;
}

/** Line breaks and surrounding spaces are invisible, so they count only within quotes. */
function visible(text: string): string {
  return text.replace(/\p{Cc}/gu, " ").trim();
}

function parsed(json: string): unknown {
  try {
    return JSON.parse(json) as unknown;
  } catch {
    return undefined;
  }
}
