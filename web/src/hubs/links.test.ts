import { expect, test } from "vitest";

import { type HubLink, type Hubs, ratesOf } from "./links";

const LINK: HubLink = {
  kind: "join",
  address: "wss://cloud",
  name: "cloud",
  id: "a",
  version: "1",
  fault: "",
  since: { secs: 1, nsecs: 0 },
  round_trip: 0.001,
  clock_offset: 0,
  messages_sent: 100,
  messages_received: 10,
  bytes_sent: 1000,
  bytes_received: 500,
  dropped: 0,
  lost: 0,
};

function hubs(secs: number, ...links: HubLink[]): Hubs {
  const hub = { id: "b", name: "robot", version: "1", link: "", distance: 0, nodes: 0 };
  return { stamp: { secs, nsecs: 0 }, hub, links, hubs: [] };
}

test("rates are those between two responses", () => {
  const later = { ...LINK, messages_sent: 140, bytes_received: 900 };
  expect(ratesOf(later, hubs(12, later), hubs(10, LINK))).toEqual({
    messagesIn: 0,
    messagesOut: 20,
    bytesIn: 200,
    bytesOut: 0,
  });
});

test("a link that is new has no rates yet", () => {
  const again = { ...LINK, since: { secs: 9, nsecs: 0 } };
  expect(ratesOf(LINK, hubs(12, LINK), null)).toBeNull();
  expect(ratesOf(again, hubs(12, again), hubs(10, LINK))).toBeNull();
  expect(ratesOf(LINK, hubs(10, LINK), hubs(10, LINK))).toBeNull();
});
