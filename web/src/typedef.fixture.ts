import type { TypeDef } from "./types";

/** Create a type definition for tests. */
export function typedef(
  type: string,
  fields: [name: string, type: string, array?: number][],
  constants: [name: string, value: string][] = [],
): TypeDef {
  return {
    type,
    fieldnames: fields.map(([name]) => name),
    fieldtypes: fields.map(([, each]) => each),
    fieldarraylen: fields.map(([, , array]) => array ?? -1),
    examples: fields.map(() => ""),
    constnames: constants.map(([name]) => name),
    constvalues: constants.map(([, value]) => value),
  };
}
