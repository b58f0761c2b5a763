import { expect, test } from "vitest";

import { LayoutEngine } from "./layout";
import { anchored, layoutRequest } from "./layout_client";
import { moved } from "./layout_types";
import type { Edge, Element, Picture } from "./picture";

const element = (id: string, label = id): Element => ({
  id,
  kind: "topic",
  name: label,
  type: "",
  group: null,
  label,
  second: "",
  fault: "",
  hub: "",
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
  conflict: "",
  direct: false,
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
const CANVAS = { width: 1280, height: 720 };

test("boxes grow with their names up to a limit", () => {
  const [short, long, longest] = layoutRequest(
    drawn({
      elements: [element("a"), element("b", "b".repeat(30)), element("c", "c".repeat(900))],
    }),
    measure,
    CANVAS,
  ).boxes;
  expect(short?.width).toBeLessThan(long?.width ?? 0);
  expect(longest?.width).toBeLessThan(400);
});

test("elements keep their places when more are added", () => {
  const engine = new LayoutEngine();
  const previous = moved(engine.layOut(layoutRequest(drawn(), measure, CANVAS)), 300, 200);
  const more = drawn({ elements: [element("a"), element("b"), element("c", "c".repeat(40))] });
  const layout = anchored(engine.layOut(layoutRequest(more, measure, CANVAS)), previous);
  expect(layout.boxes.get("a")).toEqual(previous.boxes.get("a"));
  expect(layout.boxes.get("b")).toEqual(previous.boxes.get("b"));
});

test("edges have space for their longest labels", () => {
  const room = (latched: boolean) =>
    layoutRequest(drawn({ edges: [edge(latched)] }), measure, CANVAS).links[0]?.width ?? 0;
  expect(room(false)).toBeGreaterThanOrEqual(measure("99.9 Hz"));
  expect(room(true)).toBeGreaterThanOrEqual(measure("99.9 Hz latched"));
});
