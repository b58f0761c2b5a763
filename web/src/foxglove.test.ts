import { expect, test } from "vitest";

import { applicationUrl, FOXGLOVE, LICHTBLICK } from "./foxglove";

test.each([
  [FOXGLOVE, "ws://localhost:9090/", "https://app.foxglove.dev/~/view"],
  [LICHTBLICK, "wss://lab.example/robot/?a=b&c=d", LICHTBLICK],
])("%s is to connect to %s", (application, hub, page) => {
  const url = new URL(applicationUrl(application, hub));
  expect(url.origin + url.pathname).toBe(page);
  expect(Object.fromEntries(url.searchParams)).toEqual({
    ds: "foxglove-websocket",
    "ds.url": hub,
  });
});
