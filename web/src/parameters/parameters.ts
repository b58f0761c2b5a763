/** Parameters: the services of rosapi for them, their namespaces, and their values as text. */
import type { Hub } from "../hub";

/** How many values are requested at once. */
const AT_ONCE = 32;
/** The default value in requests: null, which no parameter can have. */
const MISSING = "null";

export class ParameterServer {
  readonly #hub: Hub;

  constructor(hub: Hub) {
    this.#hub = hub;
  }

  /** All parameters by name, as JSON text, which preserves all digits of a number. */
  async all(): Promise<[name: string, value: string][]> {
    const { names } = await this.#call<{ names: string[] }>("get_param_names", "GetParamNames", {});
    const values = new Map<string, string>();
    const remaining = names.values();
    const request = async () => {
      for (const name of remaining) {
        const value = await this.#get(name);
        if (value !== MISSING) values.set(name, value);
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, request));
    return names.flatMap((name) => {
      const value = values.get(name);
      return value === undefined ? [] : [[name, value]];
    });
  }

  /** All parameters as one JSON text. */
  text(): Promise<string> {
    return this.#get("/");
  }

  async set(name: string, value: string): Promise<void> {
    await this.#call("set_param", "SetParam", { name, value });
  }

  async remove(name: string): Promise<void> {
    await this.#call("delete_param", "DeleteParam", { name });
  }

  async #get(name: string): Promise<string> {
    const request = { name, default: MISSING };
    return (await this.#call<{ value: string }>("get_param", "GetParam", request)).value;
  }

  #call<T>(service: string, type: string, request: Record<string, string>): Promise<T> {
    return this.#hub.call<T>(`/rosapi/${service}`, `rosapi/${type}`, request);
  }
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
