import { expect, test } from "vitest";

import { originUrl } from "./origin";

test.each([
  ["ws://robot:9090/", "http://robot:9090/origin"],
  ["wss://lab.example/robot/", "https://lab.example/robot/origin"],
  ["ws://[::1]:9090/", "http://[::1]:9090/origin"],
])("the hub at %s is asked at %s", (hub, url) => {
  expect(originUrl(hub)).toBe(url);
});
