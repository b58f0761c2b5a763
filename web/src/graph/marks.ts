// What stands on the screen for an element and for an arrow.

import { svg } from "../dom";
import type { Element as Drawn, Edge } from "./picture";
import type { Box, Point, Way } from "./places";
import { outline, shortened } from "./shapes";

export interface ElementMark {
  element: Drawn;
  at: Box;
  from: Point;
  to: Box;
  mark: SVGGElement;
}

export interface EdgeMark {
  edge: Edge;
  at: Way;
  from: Way;
  to: Way;
  mark: SVGGElement;
  line: SVGPathElement;
  heads: SVGPathElement;
  hit: SVGPathElement;
  words: SVGTextElement;
  /** Where the rate is read: in the words, below the topic's name if that is among them. */
  rate: SVGTextContentElement;
  title?: SVGTitleElement;
  stroke: number;
}

export function makeElement(element: Drawn, box: Box): SVGGElement {
  return svg(
    "g",
    {
      class: `element ${element.kind}`,
      role: "button",
      tabindex: 0,
      "aria-label": element.about,
      "data-id": element.id,
    },
    ...look(element, box),
  );
}

export function look({ kind, name: whole, type: itsType, label, second }: Drawn, box: Box): Node[] {
  const title = svg("title", {}, itsType === "" ? whole : `${whole}\n${itsType}`);
  const typed = second !== "";
  const name = svg("text", { class: "name", y: typed ? -2 : 4.5 }, shortened(label));
  const type = typed ? [svg("text", { class: "type", y: 12 }, shortened(second))] : [];
  return [title, ...outline(kind, box), name, ...type];
}

export function makeEdge(edge: Edge, way: Way): EdgeMark {
  const [line, heads] = [svg("path", { class: "line" }), svg("path", { class: "heads" })];
  const hit = svg("path", { class: "hit" });
  const words = svg("text", { class: "words" });
  let rate: SVGTextContentElement = words;
  if (edge.label !== "") {
    rate = svg("tspan", { class: "rate", x: 0, dy: 13 });
    words.append(svg("tspan", { class: "topic", x: 0 }, shortened(edge.label, 32)), rate);
  }
  const mark = svg("g", { class: "edge", "data-id": edge.id }, hit, line, heads, words);
  return { edge, at: way, from: way, to: way, mark, line, heads, hit, words, rate, stroke: 0 };
}

/** Set an attribute, without touching the document when it is so already: tells whether it was not. */
export function put(element: Element, name: string, value: string): boolean {
  if (element.getAttribute(name) === value) return false;
  element.setAttribute(name, value);
  return true;
}
