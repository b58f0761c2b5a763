// How large each element is, and its outline: the shape tells what it is.

import { svg } from "../dom";
import type { Element, Kind } from "./picture";

/** Gives the width of a text in pixels. */
export type Measure = (text: string, font: "name" | "node" | "type" | "rate") => number;

export interface Size {
  width: number;
  height: number;
}

const LONGEST = 42;

const FONTS = {
  name: "500 14px system-ui, sans-serif",
  node: "600 14px system-ui, sans-serif",
  type: "11px system-ui, sans-serif",
  rate: "11px system-ui, sans-serif",
};

/** Measures without touching the document, and each text once. */
export function ruler(): Measure {
  const context = document.createElement("canvas").getContext("2d");
  const kept = new Map<string, number>();
  return (text, font) => {
    const key = `${font} ${text}`;
    let width = kept.get(key);
    if (width === undefined) {
      if (context !== null) context.font = FONTS[font];
      width = context?.measureText(text).width ?? 7 * text.length;
      if (kept.size > 5000) kept.clear();
      kept.set(key, width);
    }
    return width;
  };
}

/** Long texts lose their middle: the beginning and the end tell names apart. */
export function shortened(text: string, longest = LONGEST): string {
  if (text.length <= longest) return text;
  const half = Math.floor((longest - 1) / 2);
  return `${text.slice(0, half)}…${text.slice(-half)}`;
}

export function sizeOf(element: Element, measure: Measure): Size {
  const name = measure(shortened(element.label), element.kind === "node" ? "node" : "name");
  const type = measure(shortened(element.second), "type");
  const widest = Math.max(name, type);
  const line = element.second === "" ? 0 : 10;
  switch (element.kind) {
    case "node":
      return { width: Math.round(Math.max(64, 1.06 * name + 20)), height: 44 };
    case "topic":
      return { width: Math.round(Math.max(44, widest + 18)), height: 30 + line };
    case "service":
      return { width: Math.round(Math.max(64, widest + 32)), height: 30 + line };
    case "action":
      return { width: Math.round(Math.max(64, widest + 32)), height: 38 + line };
  }
}

/** The outline around 0, 0. */
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
