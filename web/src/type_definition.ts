/** A type's definition as text of a .msg file. */
import { h } from "./dom";
import { rangeOf, type TypeDef, typeText } from "./types";

/** Elements for the definition of a type, which comes first, and of the folded types in it. */
export function definitions([first, ...inner]: readonly TypeDef[]): HTMLElement[] {
  return [
    h("pre", {}, (first && definition(first)) || "# no fields"),
    // rosapi also lists the fields of times, which are not messages.
    ...inner
      .filter(({ type }) => type.includes("/"))
      .map((each) =>
        h(
          "details",
          {},
          h("summary", { class: "mono" }, each.type),
          h("pre", {}, definition(each)),
        ),
      ),
  ];
}

/** A type as its .msg file would define it, constants first. */
export function definition(def: TypeDef): string {
  const lines: [string, string][] = def.constnames.map((name, at) => [
    constantType(def, def.constvalues[at] ?? ""),
    `${name}=${def.constvalues[at] ?? ""}`,
  ]);
  def.fieldnames.forEach((name, at) => {
    const type = def.fieldtypes[at] ?? "";
    lines.push([typeText({ name, type, array: def.fieldarraylen[at] ?? -1 }), name]);
  });
  return lines.map(([type, name]) => `${type} ${name}`).join("\n");
}

/** Guess the type of a constant, which rosapi omits: that of the first field that could hold it. */
function constantType(def: TypeDef, value: string): string {
  if (value === "True" || value === "False") return "bool";
  if (/^-?\d+$/.test(value)) {
    const fits = def.fieldtypes.find((type) => {
      const range = rangeOf(type);
      return range !== undefined && range[0] <= BigInt(value) && BigInt(value) <= range[1];
    });
    return fits ?? "int32";
  }
  return /^-?(\d|inf|nan)/.test(value) ? "float64" : "string";
}
