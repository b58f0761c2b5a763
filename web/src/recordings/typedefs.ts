/** The definitions of a recording's types, as the hub describes those that it knows. */
import { readDefinition } from "../messages/definition";
import type { TypeDef } from "../types";

/** A constant of a message: `uint8 OK=0`. */
const CONSTANT = /^[a-z]\w*(?:<=\d+)?[ \t]+([A-Za-z]\w*)[ \t]*=[ \t]*(.*?)[ \t]*$/;

/** Describe a type, and those in it; an empty list if the text is no definition of messages. */
export function typedefsOf(type: string, definition: string): TypeDef[] {
  if (!/^(\s*#.*)?\s*[A-Za-z][\w/]*(<=\d+)?(\[[^\]]*\])?\s+\w+/m.test(definition)) return [];
  const texts = definition.split(/^=+[ \t]*\r?\n(?=MSG:)/m);
  return readDefinition(type, definition).map((each, at) => {
    const constants = (texts[at] ?? "").split("\n").flatMap((line) => {
      const isText = /^w?string\b/.test(line);
      const [, name = "", value = ""] =
        CONSTANT.exec(isText ? line : line.replace(/#.*/, "")) ?? [];
      return name === "" ? [] : [{ name, value }];
    });
    return {
      type: each.type,
      fieldnames: [...each.fieldnames],
      fieldtypes: [...each.fieldtypes],
      fieldarraylen: [...each.fieldarraylen],
      examples: [],
      constnames: constants.map(({ name }) => name),
      constvalues: constants.map(({ value }) => value),
    };
  });
}
