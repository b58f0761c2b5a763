import { expect, test } from "vitest";

import type { Rates } from "../model";
import { asText } from "./as_text";
import { picture } from "./picture";
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
