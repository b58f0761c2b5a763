import { expect, test } from "vitest";

import { problemOf } from "./connection_problem";
import type { OriginAnswer } from "./origin";

const HUB = "ws://robot:9090/";
const ALLOWED: OriginAnswer = { origin: null, allowed: true, reason: "", option: "" };

test("a refused page shows the reason and the command", () => {
  const option = "--allow-origin http://robot.local:9090";
  const answer = { origin: "http://robot.local:9090", allowed: false, reason: "Why", option };
  expect(problemOf(HUB, answer, 1)).toEqual({
    text: "The hub refuses this page: Why.",
    command: `python -m fibws.hub ${option}`,
  });
});

test("a proxy that passes no WebSockets on is suspected after several failures", () => {
  expect(problemOf(HUB, ALLOWED, 1)).toBeUndefined();
  expect(problemOf(HUB, ALLOWED, 3)?.text).toContain("Upgrade");
});

test("an address without a hub is named after several failures", () => {
  expect(problemOf(HUB, undefined, 1)).toBeUndefined();
  expect(problemOf(HUB, undefined, 3)?.text).toContain(HUB);
  expect(problemOf("ws://robot/", undefined, 3)?.text).toContain("perhaps ws://robot:9090");
  expect(problemOf("wss://robot/", undefined, 3)?.text).toContain("443");
});
