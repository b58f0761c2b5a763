import { expect, test } from "vitest";

import { dotFile, opaque } from "./export";
import type { Edge, Element } from "./picture";

const element = (kind: Element["kind"], name: string, more: Partial<Element> = {}): Element => ({
  id: `${kind} ${name}`,
  kind,
  name,
  type: "",
  group: null,
  label: name,
  second: "",
  fault: "",
  hub: "",
  about: "",
  ...more,
});

const edge = (from: string, to: string, more: Partial<Edge> = {}): Edge => ({
  id: `${from} > ${to}`,
  from,
  to,
  publishers: [],
  subscriptions: [],
  label: "",
  latched: false,
  dashed: false,
  bothWays: false,
  conflict: "",
  direct: false,
  about: "",
  ...more,
});

test("DOT shows unreachable nodes and conflicts", () => {
  const text = dotFile({
    elements: [
      element("node", "/n", { second: "⚠ unreachable", fault: "Connection refused" }),
      element("topic", "/t"),
    ],
    edges: [edge("node /n", "topic /t", { conflict: "a/B" })],
    groups: [],
    typed: false,
  });
  expect(text).toContain('style=dashed, tooltip="Connection refused"');
  expect(text).toContain('[label="⚠ a/B", style=dotted]');
});

test("DOT has elements, edges and nested namespaces", () => {
  const text = dotFile({
    elements: [
      element("node", "/r/talker", { group: "/r", label: "talker" }),
      element("topic", "/r/s/chatter", { group: "/r/s", label: "chatter", second: "a/B" }),
    ],
    edges: [edge("node /r/talker", "topic /r/s/chatter", { label: "x", dashed: true })],
    groups: [
      { name: "/r", parent: null },
      { name: "/r/s", parent: "/r" },
    ],
    typed: true,
  });
  expect(text).toBe(`digraph ROS {
  rankdir=LR;
  subgraph "cluster /r" {
    label="/r";
    subgraph "cluster /r/s" {
      label="/r/s";
      "topic /r/s/chatter" [label="chatter\\na/B", shape=box];
    }
    "node /r/talker" [label="talker", shape=ellipse];
  }
  "node /r/talker" -> "topic /r/s/chatter" [label="x", style=dashed];
}
`);
});

test("names in DOT are escaped", () => {
  const text = dotFile({
    elements: [element("node", '/a"]; b \\ [')],
    edges: [],
    groups: [],
    typed: false,
  });
  expect(text).toContain('"node /a\\"]; b \\\\ [" [label=');
});

test("a colour is separated from its alpha", () => {
  expect(opaque("rgba(1, 2, 3, 0.5)")).toEqual(["rgb(1, 2, 3)", "0.5"]);
  expect(opaque("rgb(1, 2, 3)")).toEqual(["rgb(1, 2, 3)", null]);
  expect(opaque("none")).toEqual(["none", null]);
});
