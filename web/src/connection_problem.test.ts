import { expect, test } from "vitest";

import { problemOf } from "./connection_problem";
import type { OriginAnswer } from "./origin";

const ALLOWED: OriginAnswer = { origin: null, allowed: true, reason: "", option: "" };

test("a refused page shows the reason and the command", () => {
  const option = "--allow-origin http://robot.local:9090";
  const answer = { origin: "http://robot.local:9090", allowed: false, reason: "Why", option };
  expect(problemOf(answer, 1)).toEqual({
    text: "The hub refuses this page: Why.",
    command: `python -m fibws.hub ${option}`,
  });
});

test("a proxy that passes no WebSockets on is suspected after several failures", () => {
  expect(problemOf(ALLOWED, 1)).toBeUndefined();
  expect(problemOf(ALLOWED, 3)?.text).toContain("Upgrade");
});
