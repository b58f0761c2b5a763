import { expect, test } from "vitest";

import type { Rates } from "../model";
import { NO_RATES } from "../rates";
import { asText } from "./as_text";
import { NO_MESSAGES } from "./conflicts";
import { type Picture, picture } from "./picture";
import { DEFAULTS } from "./toolbar";

test("each node and topic is listed with its edges", () => {
  const drawn = picture(
    {
      revision: 1,
      nodes: ["/talker", "/listener"].map((name) => ({
        name,
        address: "",
        since: { secs: 0, nsecs: 0 },
        own: false,
        api: "",
        fault: "",
        hub: "",
      })),
      topics: [
        {
          name: "/chatter",
          type: "std_msgs/String",
          checked: true,
          publishers: [{ node: "/talker", latch: true }],
          subscriptions: [
            { node: "/listener", queue_length: 0, throttle_rate: 0, compression: "none" },
          ],
          conflicts: [],
        },
      ],
      services: [],
      actions: [],
    },
    DEFAULTS,
  );
  const rates: Rates = {
    topics: new Map(),
    publishers: new Map([["/chatter /talker", { messages: 1, bytes: 8, dropped: 0 }]]),
    subscriptions: new Map(),
    dropped: new Map(),
  };
  expect(asText(drawn, rates).split("\n")).toEqual([
    "node /listener",
    "  <─ /chatter",
    "node /talker",
    "  ─> /chatter  1.0 Hz  latched",
    "topic /chatter [std_msgs/String]",
    "  ─> /listener",
    "  <─ /talker  1.0 Hz",
  ]);
});

test("unreachable nodes and conflicts are named", () => {
  const about = { type: "", group: null, second: "", hub: "", about: "" };
  const edge = {
    ...{ id: "e", from: "node /n", to: "topic /t", publishers: [], subscriptions: [], label: "" },
    ...{ latched: false, dashed: false, bothWays: false, direct: false, about: "" },
    conflict: "a/B",
  };
  const drawn: Picture = {
    elements: [
      { ...about, id: "node /n", kind: "node", name: "/n", label: "/n", fault: "Timed out" },
      { ...about, id: "topic /t", kind: "topic", name: "/t", label: "/t", fault: "" },
    ],
    edges: [edge, { ...edge, id: "f", from: "topic /t", to: "node /n", conflict: NO_MESSAGES }],
    groups: [],
    typed: false,
  };
  expect(asText(drawn, NO_RATES).split("\n")).toEqual([
    "node /n  unreachable: Timed out",
    "  ─> /t  no messages: type a/B",
    "  <─ /t  no messages",
    "topic /t",
    "  ─> /n  no messages",
    "  <─ /n  no messages: type a/B",
  ]);
});
