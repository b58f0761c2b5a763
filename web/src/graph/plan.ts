// From a picture to what the layout needs to know of it, and from one layout to the next.

import type { Edge, Picture } from "./picture";
import { moved, type Places, type Plan } from "./places";
import { type Measure, shortened, sizeOf } from "./shapes";

/** Room for `999 Hz` and a mark, so that a rate that changes moves nothing. */
const RATE = "99.9 Hz";
const LATCHED = `${RATE} latched`;
const PADDING = 4;
const LINE = 15;

export function planOf(
  picture: Picture,
  measure: Measure,
  screen: { aspect: number; down: boolean },
): Plan {
  return {
    boxes: picture.elements.map((element) => ({
      id: element.id,
      group: element.group,
      ...sizeOf(element, measure),
    })),
    links: picture.edges.map((edge) => ({
      id: edge.id,
      from: edge.from,
      to: edge.to,
      ...roomFor(edge, measure),
    })),
    groups: picture.groups.map(({ name, parent }) => ({
      name,
      parent,
      width: Math.round(measure(name, "rate") + 12),
    })),
    ...screen,
  };
}

function roomFor(edge: Edge, measure: Measure): { width: number; height: number } {
  if (edge.publishers.length + edge.subscriptions.length === 0) return { width: 8, height: 8 };
  const rate = measure(edge.latched ? LATCHED : RATE, "rate");
  if (edge.label === "") return { width: Math.round(rate + PADDING), height: LINE };
  const topic = measure(shortened(edge.label, 32), "rate");
  return { width: Math.round(Math.max(rate, topic) + PADDING), height: 2 * LINE };
}

/** The new places, moved as a whole so that what stayed is where it was, as far as can be. */
export function anchored(places: Places, former: Places): Places {
  const steps = [...places.boxes].flatMap(([id, { x, y }]) => {
    const was = former.boxes.get(id);
    return was === undefined ? [] : [{ x: was.x - x, y: was.y - y }];
  });
  return moved(places, median(steps.map(({ x }) => x)), median(steps.map(({ y }) => y)));
}

function median(numbers: number[]): number {
  const sorted = numbers.sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}
