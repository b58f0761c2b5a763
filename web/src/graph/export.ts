/** Saves the graph as a file: the drawing as SVG, its elements and edges as DOT for Graphviz. */

import { h, svg } from "../dom";
import type { Bounds } from "./layout_types";
import type { Edge, Element, Group, Kind, Picture } from "./picture";

const SHAPES: Record<Kind, string> = {
  node: "ellipse",
  topic: "box",
  service: "hexagon",
  action: "box, style=rounded",
};

/** The elements and edges in Graphviz's language, with a cluster for each namespace. */
export function dotFile({ elements, edges, groups }: Picture): string {
  const element = ({ id, kind, label, type, second, fault }: Element): string => {
    const lines = second === "" ? label : `${label}\n${second}`;
    const more = fault || type;
    const tooltip = more === "" ? "" : `, tooltip=${quoted(more)}`;
    const style = fault === "" ? "" : ", style=dashed";
    return `${quoted(id)} [label=${quoted(lines)}, shape=${SHAPES[kind]}${style}${tooltip}];`;
  };
  const edge = ({ from, to, label, dashed, bothWays, conflict }: Edge): string => {
    const lines = [label, conflict === "" ? "" : `⚠ ${conflict}`].filter((each) => each !== "");
    const attributes = [
      lines.length === 0 ? "" : `label=${quoted(lines.join("\n"))}`,
      dashed ? "style=dashed" : conflict === "" ? "" : "style=dotted",
      bothWays ? "dir=both" : "",
    ].filter((each) => each !== "");
    const list = attributes.length === 0 ? "" : ` [${attributes.join(", ")}]`;
    return `${quoted(from)} -> ${quoted(to)}${list};`;
  };
  const members = (group: string | null): string[] => [
    ...groups.filter(({ parent }) => parent === group).flatMap(cluster),
    ...elements.filter((each) => each.group === group).map(element),
  ];
  const cluster = ({ name }: Group): string[] => [
    `subgraph ${quoted(`cluster ${name}`)} {`,
    `  label=${quoted(name)};`,
    ...members(name).map((line) => `  ${line}`),
    "}",
  ];
  const lines = ["rankdir=LR;", ...members(null), ...edges.map(edge)];
  return `digraph ROS {\n${lines.map((line) => `  ${line}\n`).join("")}}\n`;
}

/** A string of DOT; a line break is written as `\n`. */
function quoted(text: string): string {
  const escaped = text.replaceAll("\\", "\\\\").replaceAll('"', '\\"').replaceAll("\n", "\\n");
  return `"${escaped}"`;
}

/** The space around the drawing in the file, in pixels. */
const MARGIN = 16;
const COLOURS = ["fill", "stroke"] as const;
const STYLES = {
  shape: ["fill-opacity", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linecap"],
  text: [
    "font-family",
    "font-size",
    "font-weight",
    "text-anchor",
    "stroke-width",
    "stroke-linejoin",
    "paint-order",
  ],
};

/**
 * The drawing as an SVG file that needs nothing else: in light colours, all of it, at a zoom of 1.
 *
 * Other programs know neither the page's stylesheet nor its variables, so each mark gets its styles
 * as attributes.
 */
export function svgFile(drawing: SVGSVGElement, bounds: Bounds): string {
  const copy = drawing.cloneNode(true) as SVGSVGElement;
  copy.removeAttribute("class");
  copy.removeAttribute("style");
  for (const mark of copy.querySelectorAll(".hit")) mark.remove();
  for (const mark of copy.querySelectorAll(".fresh, .lit, .near")) {
    mark.classList.remove("fresh", "lit", "near");
  }
  for (const title of copy.querySelectorAll<SVGElement>(".group-name")) {
    (title.parentNode as SVGElement).style.setProperty("--zoom", "1");
  }
  const place = h("div", { class: "graph export" }, copy);
  document.body.append(place);
  // Nothing is painted in between.
  document.documentElement.classList.add("light");
  try {
    for (const mark of copy.querySelectorAll<SVGElement>(MARKS)) inlineStyles(mark);
    const paper = getComputedStyle(place).backgroundColor;
    const [x, y] = [bounds.left - MARGIN, bounds.top - MARGIN];
    const [width, height] = [bounds.width + 2 * MARGIN, bounds.height + 2 * MARGIN];
    copy.prepend(svg("rect", { x, y, width, height, fill: paper }));
    for (const [name, value] of Object.entries({
      viewBox: [x, y, width, height].map((each) => each.toFixed(1)).join(" "),
      width: width.toFixed(0),
      height: height.toFixed(0),
    })) {
      copy.setAttribute(name, value);
    }
  } finally {
    document.documentElement.classList.remove("light");
    place.remove();
  }
  for (const mark of copy.querySelectorAll("*")) {
    for (const name of ["class", "style", "role", "tabindex", "aria-label", "aria-pressed"]) {
      mark.removeAttribute(name);
    }
  }
  return `${new XMLSerializer().serializeToString(copy)}\n`;
}

const MARKS = "rect, ellipse, polygon, path, text, tspan";

function inlineStyles(mark: SVGElement): void {
  const computed = getComputedStyle(mark);
  const isText = mark.matches("text, tspan");
  for (const name of isText ? STYLES.text : STYLES.shape) {
    mark.setAttribute(name, computed.getPropertyValue(name));
  }
  for (const name of COLOURS) {
    const [colour, alpha] = opaque(computed.getPropertyValue(name));
    mark.setAttribute(name, colour);
    if (alpha !== null) mark.setAttribute(`${name}-opacity`, alpha);
  }
}

/** A colour without its alpha, and the alpha, which some programs do not know in a colour. */
export function opaque(colour: string): [colour: string, alpha: string | null] {
  const found = /^rgba\(([^,]+,[^,]+,[^,]+), *([\d.]+)\)$/.exec(colour);
  return found === null ? [colour, null] : [`rgb(${found[1]})`, found[2] as string];
}
