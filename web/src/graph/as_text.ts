/** The picture as text, for screen readers and for copying. */

import { hertz } from "../format";
import type { Rates } from "../model";
import { NO_MESSAGES } from "./conflicts";
import type { Edge, Picture } from "./picture";

/** A line for each element with its type, followed by its edges. */
export function asText({ elements, edges }: Picture, rates: Rates): string {
  const byId = new Map(elements.map((element) => [element.id, element]));
  const into = new Map<string, typeof edges>();
  const out = new Map<string, typeof edges>();
  for (const edge of edges) {
    into.set(edge.to, [...(into.get(edge.to) ?? []), edge]);
    out.set(edge.from, [...(out.get(edge.from) ?? []), edge]);
  }
  const flow = ({ publishers, subscriptions }: Edge): string => {
    let messages = 0;
    for (const key of publishers.length > 0 ? publishers : subscriptions) {
      messages += (rates.publishers.get(key) ?? rates.subscriptions.get(key))?.messages ?? 0;
    }
    return messages > 0 ? `  ${hertz(messages)}` : "";
  };
  return elements
    .filter(({ kind }) => kind !== "topic")
    .concat(elements.filter(({ kind }) => kind === "topic"))
    .flatMap(({ id, kind, name, type, fault, hub }) => [
      `${kind} ${name}${type === "" ? "" : ` [${type}]`}${hub && `  (hub ${hub})`}` +
        (fault && `  unreachable: ${fault}`),
      ...(out.get(id) ?? []).map(
        (edge) =>
          `  ─> ${edge.label ? `${edge.label} ─> ` : ""}${byId.get(edge.to)?.name}${flow(edge)}` +
          (edge.latched ? "  latched" : "") +
          flag(edge),
      ),
      ...(into.get(id) ?? []).map(
        (edge) =>
          `  <─ ${edge.label ? `${edge.label} <─ ` : ""}${byId.get(edge.from)?.name}${flow(edge)}` +
          flag(edge),
      ),
    ])
    .join("\n");
}

const flag = ({ conflict }: Edge): string =>
  conflict === "" ? "" : `  ${NO_MESSAGES}${conflict === NO_MESSAGES ? "" : `: type ${conflict}`}`;
