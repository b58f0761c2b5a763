/** A parameter's value: JSON text on the wire, and what a person reads and writes. */

/** What a JSON text stands for, in a word. */
export function kind(json: string): string {
  const value = parsed(json);
  switch (typeof value) {
    case "string":
      return "text";
    case "boolean":
      return "true or false";
    case "number":
      // JSON.parse would take 1.0 for 1; ROS does not.
      return /^-?\d+$/.test(json.trim()) ? "integer" : "number";
    case "object":
      if (value === null) return "nothing";
      return Array.isArray(value) ? "list" : "object";
    default:
      return "text";
  }
}

/** A value as it is written: JSON, but a text that reads as nothing else goes without quotes. */
export function written(json: string): string {
  const value = parsed(json);
  const plain = typeof value === "string" && value !== "" && meant(value) === JSON.stringify(value);
  return plain ? value : json;
}

/** The JSON text that a person means: what is no JSON is a text itself. */
export function meant(text: string): string {
  const trimmed = text.trim();
  return parsed(trimmed) === undefined ? JSON.stringify(printable(text)) : trimmed;
}

/** One cannot see ends of lines and blanks at the ends; only quotes say that they are meant. */
function printable(text: string): string {
  return text.replace(/\p{Cc}/gu, " ").trim();
}

function parsed(json: string): unknown {
  try {
    return JSON.parse(json) as unknown;
  } catch {
    return undefined;
  }
}
