import { expect, it } from "vitest";

import { Arranger } from "./arrange";
import type { Edge, Element, Picture } from "./picture";
import { moved } from "./places";
import { anchored, planOf } from "./plan";

const element = (id: string, label = id): Element => ({
  id,
  kind: "topic",
  name: label,
  type: "",
  group: null,
  label,
  second: "",
  about: "",
});

const edge = (latched: boolean): Edge => ({
  id: "e",
  from: "a",
  to: "b",
  publishers: ["t n"],
  subscriptions: [],
  label: "",
  latched,
  dashed: false,
  bothWays: false,
  about: "",
});

const drawn = (more: Partial<Picture> = {}): Picture => ({
  elements: [element("a"), element("b")],
  edges: [edge(false)],
  groups: [],
  typed: false,
  ...more,
});

const measure = (text: string): number => 7 * text.length;
const SCREEN = { aspect: 1.6, down: false };

it("gives longer names larger boxes, and the longest an end", () => {
  const [short, long, longest] = planOf(
    drawn({
      elements: [element("a"), element("b", "b".repeat(30)), element("c", "c".repeat(900))],
    }),
    measure,
    SCREEN,
  ).boxes;
  expect(short?.width).toBeLessThan(long?.width ?? 0);
  expect(longest?.width).toBeLessThan(400);
});

it("keeps what stayed where it was when more comes", () => {
  const arranger = new Arranger();
  const former = moved(arranger.arrange(planOf(drawn(), measure, SCREEN)), 300, 200);
  const more = drawn({ elements: [element("a"), element("b"), element("c", "c".repeat(40))] });
  const places = anchored(arranger.arrange(planOf(more, measure, SCREEN)), former);
  expect(places.boxes.get("a")).toEqual(former.boxes.get("a"));
  expect(places.boxes.get("b")).toEqual(former.boxes.get("b"));
});

it("leaves room for all that an arrow may come to say", () => {
  const room = (latched: boolean) =>
    planOf(drawn({ edges: [edge(latched)] }), measure, SCREEN).links[0]?.width ?? 0;
  expect(room(false)).toBeGreaterThanOrEqual(measure("99.9 Hz"));
  expect(room(true)).toBeGreaterThanOrEqual(measure("99.9 Hz latched"));
});
