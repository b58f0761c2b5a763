/** The SVG shapes of elements and edges: sizes, outlines, labels. */

import { svg } from "../dom";
import { bandwidth, hertz, whole } from "../format";
import { greatest } from "../lists";
import type { Rates } from "../model";
import type { Box, EdgePath, Point, Size } from "./layout_types";
import type { Edge, Kind, Element as PictureElement } from "./picture";

/** Measures the width of a text in pixels. */
export type Measure = (text: string, font: "name" | "node" | "type" | "rate") => number;

/** The maximum length of a label, in characters. */
const MAX_LABEL = 54;
/** Longer labels are broken into lines. */
const MAX_LINE = 20;
const MAX_LINES = 3;
/** The distance of two lines of a label, in pixels. */
const LINE = 15;

const FONTS = {
  name: "500 14px system-ui, sans-serif",
  node: "600 14px system-ui, sans-serif",
  type: "11px system-ui, sans-serif",
  rate: "11px system-ui, sans-serif",
};

/** Create a measure that works off the document and remembers its results. */
export function textMeasure(): Measure {
  const context = document.createElement("canvas").getContext("2d");
  const cache = new Map<string, number>();
  return (text, font) => {
    const key = `${font} ${text}`;
    let width = cache.get(key);
    if (width === undefined) {
      if (context !== null) context.font = FONTS[font];
      width = context?.measureText(text).width ?? 7 * text.length;
      if (cache.size > 5000) cache.clear();
      cache.set(key, width);
    }
    return width;
  };
}

/** Cut the middle out of a long text, since names differ at their beginning or end. */
export function shortened(text: string, limit = MAX_LABEL): string {
  if (text.length <= limit) return text;
  const half = Math.floor((limit - 1) / 2);
  return `${text.slice(0, half)}…${text.slice(-half)}`;
}

/** Break a long label into lines of similar length, after its slashes and underscores only. */
export function linesOf(label: string): string[] {
  const text = shortened(label);
  const words = text.match(/[^/_]+[/_]*|[/_]+/g) ?? [""];
  const count = Math.min(MAX_LINES, filled(words, MAX_LINE).length);
  // The lowest limit gives the most similar lines.
  for (let limit = Math.ceil(text.length / count); ; limit += 1) {
    const lines = filled(words, limit);
    if (lines.length <= count) return lines;
  }
}

/** Words in lines of a limited length; a longer word has a line of its own. */
function filled([first = "", ...others]: readonly string[], limit: number): string[] {
  const lines = [first];
  for (const word of others) {
    const longer = `${lines.at(-1)}${word}`;
    if (longer.length <= limit) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

export function sizeOf(element: PictureElement, measure: Measure): Size {
  const lines = linesOf(element.label);
  const font = element.kind === "node" ? "node" : "name";
  const name = greatest(lines.map((each) => measure(each, font)));
  const type = measure(shortened(element.second), "type");
  const widest = Math.max(name, type);
  const more = LINE * (lines.length - 1);
  const line = (element.second === "" ? 0 : 10) + more;
  switch (element.kind) {
    case "node": {
      const count = lines.length + (element.second === "" ? 0 : 1);
      const height = 44 + 0.7 * LINE * (count - 1);
      // The corners of the text are inside the ellipse.
      const part = (LINE * count - 4) / height;
      const width = widest / Math.sqrt(1 - part ** 2) + 16;
      return { width: Math.round(Math.max(64, width)), height };
    }
    case "topic":
      return { width: Math.round(Math.max(44, widest + 18)), height: 30 + line };
    case "service":
      return { width: Math.round(Math.max(64, widest + 32)), height: 30 + line };
    case "action":
      return { width: Math.round(Math.max(64, widest + 32)), height: 38 + line };
  }
}

/** The outline of an element, centred at the origin. */
export function outline(kind: Kind, { width, height }: Size): SVGElement[] {
  const [x, y] = [width / 2, height / 2];
  switch (kind) {
    case "node":
      return [svg("ellipse", { class: "outline", rx: x, ry: y })];
    case "topic":
      return [svg("rect", { class: "outline", x: -x, y: -y, width, height, rx: 5 })];
    case "service": {
      const cut = 14;
      const [a, b] = [x - cut, x];
      const corners = `${-b},0 ${-a},${-y} ${a},${-y} ${b},0 ${a},${y} ${-a},${y}`;
      return [svg("polygon", { class: "outline", points: corners })];
    }
    case "action":
      return [
        svg("rect", { class: "outline", x: -x, y: -y, width, height, rx: y }),
        svg("rect", {
          class: "inline",
          x: -x + 4,
          y: -y + 4,
          width: width - 8,
          height: height - 8,
          rx: y - 4,
        }),
      ];
  }
}

/** An element on the screen: its position now, before and after the animation. */
export interface ElementMark {
  element: PictureElement;
  at: Box;
  from: Point;
  to: Box;
  mark: SVGGElement;
}

/** An edge on the screen. */
export interface EdgeMark {
  edge: Edge;
  at: EdgePath;
  from: EdgePath;
  to: EdgePath;
  mark: SVGGElement;
  line: SVGPathElement;
  heads: SVGPathElement;
  hit: SVGPathElement;
  label: SVGTextElement;
  /** The text of the rate: all of the label, or its line below the topic's name. */
  rate: SVGTextContentElement;
  title?: SVGTitleElement;
  stroke: number;
}

export function makeElement(element: PictureElement, box: Box): SVGGElement {
  return svg(
    "g",
    {
      class: `element ${element.kind}${element.fault === "" ? "" : " unreachable"}`,
      role: "button",
      tabindex: 0,
      "aria-label": element.about,
      "data-id": element.id,
    },
    ...elementContent(element, box),
  );
}

/** The SVG content of an element. */
export function elementContent(
  { kind, name, type, label, second, fault }: PictureElement,
  box: Box,
): (Node | string)[] {
  const more = fault === "" ? type : `unreachable: ${fault}`;
  const title = svg("title", {}, more === "" ? name : `${name}\n${more}`);
  const hasType = second !== "";
  const lines = linesOf(label);
  const middle = (LINE * (lines.length - 1)) / 2;
  const text = svg(
    "text",
    { class: "name", y: (hasType ? -2 : 4.5) - middle },
    ...lines.map((line, index) => svg("tspan", { x: 0, dy: index === 0 ? 0 : LINE }, line)),
  );
  const typeLine = svg("text", { class: "type", y: 12 + middle }, shortened(second));
  return [title, ...outline(kind, box), text, hasType ? typeLine : ""];
}

export function makeEdge(edge: Edge, path: EdgePath): EdgeMark {
  const [line, heads] = [svg("path", { class: "line" }), svg("path", { class: "heads" })];
  const hit = svg("path", { class: "hit" });
  const label = svg("text", { class: "words" });
  let rate: SVGTextContentElement = label;
  if (edge.label !== "") {
    rate = svg("tspan", { class: "rate", x: 0, dy: 13 });
    label.append(svg("tspan", { class: "topic", x: 0 }, shortened(edge.label, 32)), rate);
  }
  const mark = svg("g", { class: "edge", "data-id": edge.id }, hit, line, heads, label);
  return { edge, at: path, from: path, to: path, mark, line, heads, hit, label, rate, stroke: 0 };
}

/** The label of an edge without messages, since types differ. */
export const conflictLabel = ({ conflict }: Edge): string => `⚠ ${shortened(conflict, 24)}`;

/** How an edge shows its rate. */
export interface RateLabel {
  /** The label at the edge; empty without messages. */
  label: string;
  /** The tooltip. */
  title: string;
  /** The width of the line in pixels, logarithmic. */
  stroke: number;
  idle: boolean;
  drops: boolean;
}

/** The width of an idle edge, and how much ten times the rate adds, in pixels. */
const MIN_STROKE = 1.25;
const STROKE_STEP = 0.75;

export function rateLabel(edge: Edge, rates: Rates): RateLabel {
  if (edge.conflict !== "") {
    const [label, title] = [conflictLabel(edge), edge.about];
    return { label, title, stroke: MIN_STROKE, idle: false, drops: false };
  }
  let messages = 0;
  let bytes = 0;
  let dropping = 0;
  let dropped = 0;
  const counted = edge.publishers.length > 0 ? edge.publishers : edge.subscriptions;
  for (const key of edge.bothWays ? [...edge.publishers, ...edge.subscriptions] : counted) {
    const flow = rates.publishers.get(key) ?? rates.subscriptions.get(key);
    messages += flow?.messages ?? 0;
    bytes += flow?.bytes ?? 0;
  }
  for (const key of edge.subscriptions) {
    dropping += rates.subscriptions.get(key)?.dropped ?? 0;
    dropped += rates.dropped.get(key) ?? 0;
  }
  const rate = messages > 0 ? hertz(messages) : "";
  const parts = [dropping > 0 ? "⚠" : "", rate, edge.latched ? "latched" : ""];
  const words = [`${edge.about}: ${hertz(messages)}`];
  if (edge.direct) words.push("messages between ROS 1 nodes are not counted");
  if (bytes > 0) words.push(bandwidth(bytes));
  if (dropped > 0) {
    words.push(
      `${whole(dropped)} dropped since it subscribed${dropping > 0 ? `, ${hertz(dropping)} now` : ""}`,
    );
  }
  return {
    label: parts.filter((part) => part !== "").join(" "),
    title: words.join(", "),
    stroke: Number((MIN_STROKE + STROKE_STEP * Math.log10(1 + Math.max(0, messages))).toFixed(2)),
    idle: messages === 0,
    drops: dropping > 0,
  };
}
