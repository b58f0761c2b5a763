/** A type's definition as its .msg file would have it; the types in it are folded. */
import { h } from "./dom";
import { definition, type TypeDef } from "./types";

/** Elements for a list of types that begins with the one that was asked for. */
export function definitions([asked, ...inner]: readonly TypeDef[]): HTMLElement[] {
  return [
    h("pre", {}, (asked && definition(asked)) || "# no fields"),
    // Times are no messages, though rosapi tells what is in them.
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
