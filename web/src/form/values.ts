/** Values of messages: the initial ones, checking, and the form in which they are sent. */
import { type Field, isBytes, kindOf, own, type Types, typeText } from "../types";
import {
  lengthProblem,
  objectOf,
  type Problem,
  parseBytes,
  parseText,
  type Result,
  timeFromNanoseconds,
} from "./parsing";

/** The initial value of a field. The time of a header is the time of publishing. */
export function initial(types: Types, field: Field, message = ""): unknown {
  if (isBytes(field)) return btoa("\0".repeat(Math.max(0, field.array)));
  if (field.array >= 0) {
    return Array.from({ length: field.array }, () => initialElement(types, field, message));
  }
  return initialElement(types, field, message);
}

/** The initial value of an element of an array field, or of a field that is not an array. */
export function initialElement(types: Types, field: Field, message = ""): unknown {
  switch (kindOf(field.type)) {
    case "integer":
    case "float":
      return 0;
    case "bool":
      return false;
    case "string":
      return "";
    case "time":
      return message === "std_msgs/Header" ? "now" : { secs: 0, nsecs: 0 };
    case "duration":
      return { secs: 0, nsecs: 0 };
    case "message":
      return initialMessage(types, field.type);
  }
}

export function initialMessage(types: Types, type: string): Record<string, unknown> {
  return objectOf(types.fields(type).map((field) => [field.name, initial(types, field, type)]));
}

/** Check a message that was entered as JSON; returns it as it will be sent. */
export function checkMessage(
  types: Types,
  type: string,
  value: unknown,
  problems: Problem[],
  path = "",
): unknown {
  if (typeof value !== "object" || value === null || Array.isArray(value)) {
    problems.push({ path, text: `expected an object {…} for ${type}` });
    return value;
  }
  const checked: [string, unknown][] = [];
  for (const name of Object.keys(value)) {
    const field = types.field(type, name);
    const at = path === "" ? name : `${path}.${name}`;
    if (field === undefined) {
      const names = types.fields(type).map((each) => each.name);
      const known = names.length === 0 ? "none" : names.join(", ");
      problems.push({ path: at, text: `unknown field of ${type}; its fields are ${known}` });
    } else {
      checked.push([name, checkField(types, field, own(value, name), problems, at)]);
    }
  }
  return objectOf(checked);
}

/** Like `checkMessage`, for one field. */
export function checkField(
  types: Types,
  field: Field,
  value: unknown,
  problems: Problem[],
  path: string,
): unknown {
  if (isBytes(field)) {
    const result = parseBytes(
      field,
      typeof value === "string" ? value : (JSON.stringify(value) ?? ""),
    );
    return valueOrProblem(result, value, problems, path);
  }
  if (field.array < 0) return checkElement(types, field, value, problems, path);
  if (!Array.isArray(value)) {
    problems.push({ path, text: `expected a list […] for ${typeText(field)}` });
    return value;
  }
  const length = lengthProblem(field, value.length);
  if (length !== undefined) problems.push({ path, text: length });
  return value.map((each, at) => checkElement(types, field, each, problems, `${path}[${at}]`));
}

function checkElement(
  types: Types,
  field: Field,
  value: unknown,
  problems: Problem[],
  path: string,
): unknown {
  const kind = kindOf(field.type);
  if (kind === "message") return checkMessage(types, field.type, value, problems, path);
  if (kind === "time" || kind === "duration") {
    if (value === "now" && kind === "time") return value;
    const secs = own(value, "secs") ?? 0;
    const nsecs = own(value, "nsecs") ?? 0;
    if (typeof value !== "object" || !Number.isInteger(secs) || !Number.isInteger(nsecs)) {
      problems.push({
        path,
        text: `expected {"secs": 0, "nsecs": 0}${kind === "time" ? ' or "now"' : ""} for ${kind}`,
      });
      return value;
    }
    const total = BigInt(secs as number) * 1_000_000_000n + BigInt(nsecs as number);
    return valueOrProblem(timeFromNanoseconds(kind, total, String(secs)), value, problems, path);
  }
  const isValid =
    (kind === "string" && typeof value === "string") ||
    (kind === "bool" && typeof value === "boolean") ||
    (kind === "float" &&
      (value === null || typeof value === "number" || typeof value === "string")) ||
    (kind === "integer" && (typeof value === "number" || typeof value === "string"));
  if (!isValid) {
    problems.push({
      path,
      text: `expected ${field.type}, got ${JSON.stringify(value) ?? "nothing"}`,
    });
    return value;
  }
  return valueOrProblem(
    parseText(field.type, value === null ? "nan" : String(value)),
    value,
    problems,
    path,
  );
}

function valueOrProblem(
  result: Result,
  value: unknown,
  problems: Problem[],
  path: string,
): unknown {
  if ("value" in result) return result.value;
  problems.push({ path, text: result.problem });
  return value;
}

/**
 * Prepare a checked message for `JSON.stringify`: large integers keep all digits.
 *
 * In browsers without `JSON.rawJSON` they stay strings.
 */
export function sendable(types: Types, type: string, message: unknown): Record<string, unknown> {
  return objectOf(
    types.fields(type).flatMap((field): [string, unknown][] => {
      if (typeof message !== "object" || message === null || !Object.hasOwn(message, field.name))
        return [];
      const value = own(message, field.name);
      if (field.array >= 0 && Array.isArray(value)) {
        return [[field.name, value.map((each) => sendableElement(types, field.type, each))]];
      }
      return [[field.name, sendableElement(types, field.type, value)]];
    }),
  );
}

function sendableElement(types: Types, type: string, value: unknown): unknown {
  const kind = kindOf(type);
  if (kind === "message") return sendable(types, type, value);
  const digits = (type === "int64" || type === "uint64") && typeof value === "string";
  if (digits) return raw(value);
  return value;
}

function raw(digits: string): unknown {
  const json = JSON as typeof JSON & { rawJSON?: (text: string) => unknown };
  return json.rawJSON === undefined ? digits : json.rawJSON(digits);
}
