import { afterEach, expect, test, vi } from "vitest";

import { Ros } from "./roslib";

/** What passes an event on; roslib's types know no hub's fields, nor the event of a close. */
const emit = (ros: Ros, event: string, value: unknown): boolean =>
  ros.emit(event, value as Parameters<Ros["emit"]>[1]);

afterEach(() => {
  vi.restoreAllMocks();
});

test("a status in the console names the topic, not roslib's id", () => {
  const error = vi.spyOn(console, "error").mockImplementation(() => undefined);
  const id = "publish:/chatter:123236e9-e205-45c3-992d-4d186e547b2a";
  const status = { op: "status", level: "error", msg: "publish: no field dta" };
  emit(new Ros(), `status:${id}`, { ...status, operation: id });
  emit(new Ros(), "status", status);
  emit(new Ros(), "status:mine", { ...status, id: "mine" });
  expect(error.mock.calls).toEqual([
    ["The hub says about /chatter: publish: no field dta"],
    ["The hub says: publish: no field dta"],
    ["The hub says about mine: publish: no field dta"],
  ]);
});

test("why the hub has ended a connection is in the console", () => {
  const error = vi.spyOn(console, "error").mockImplementation(() => undefined);
  const ros = new Ros();
  const seen: unknown[] = [];
  ros.on("close", (event) => seen.push(event));
  emit(ros, "close", { code: 1001, reason: "" });
  emit(ros, "close", { code: 4401, reason: "unknown token" });
  emit(ros, "close", undefined);
  expect(seen).toHaveLength(3);
  expect(error.mock.calls).toEqual([["The hub has closed the connection: unknown token (4401)"]]);
});
