import { afterEach, beforeEach, expect, test, vi } from "vitest";

import {
  CallTimeout,
  Hub,
  hubUrl,
  isDefaultHub,
  type Operation,
  splitToken,
  withNode,
} from "./hub";

/** Stands in for the browser's WebSocket: the test plays the hub. */
class FakeSocket {
  static all: FakeSocket[] = [];
  readonly url: string;
  readonly sent: Operation[] = [];
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  onclose: ((event: { code: number; reason: string }) => void) | null = null;
  closed = false;
  readyState = 0;

  constructor(url: string) {
    if (url.includes(" ")) throw new SyntaxError(`The URL '${url}' is invalid.`);
    this.url = url;
    FakeSocket.all.push(this);
  }

  send(data: string): void {
    this.sent.push(JSON.parse(data));
  }

  close(): void {
    this.closed = true;
  }
}

let hub: Hub;

const socket = (): FakeSocket => FakeSocket.all.at(-1) as FakeSocket;
const open = (): void => {
  socket().readyState = 1;
  socket().onopen?.();
};
const receive = (operation: Operation): void =>
  socket().onmessage?.({ data: JSON.stringify(operation) });
const close = (code = 1001, reason = "the hub is shutting down"): void =>
  socket().onclose?.({ code, reason });

/** Remove and return the sent operations of one kind. */
function take(op: string): Operation[] {
  const taken = socket().sent.filter((operation) => operation.op === op);
  socket().sent.length = 0;
  return taken;
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("window", globalThis);
  vi.stubGlobal("WebSocket", FakeSocket);
  FakeSocket.all = [];
  hub = new Hub("ws://hub/");
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

test("the page connects as a node", () => {
  expect(socket().url).toBe(`ws://hub/?node=${hub.node}`);
  expect(hub.state.value).toBe("connecting");
  open();
  expect(hub.state.value).toBe("open");
});

test("a goal is sent, canceled, and ends once", () => {
  open();
  const [onFeedback, onEnd] = [vi.fn(), vi.fn()];
  const cancel = hub.sendGoal({ action: "/a", type: "a/A", values: { to: 8 } }, onFeedback, onEnd);
  const [goal] = take("send_action_goal");
  const id = goal?.id;
  expect(goal).toMatchObject({ action: "/a", action_type: "a/A", args: { to: 8 }, feedback: true });
  receive({ op: "action_feedback", id, action: "/a", values: { at: 1 } });
  expect(onFeedback).toHaveBeenCalledWith({ at: 1 });
  cancel();
  expect(take("cancel_action_goal")).toMatchObject([{ id, action: "/a" }]);
  const result = { op: "action_result", id, action: "/a", status: 5, result: true, values: {} };
  receive(result);
  receive(result);
  expect(onEnd.mock.calls).toEqual([[{ status: 5, result: true, values: {} }]]);
  cancel();
  expect(take("cancel_action_goal")).toEqual([]);
});

test("a goal ends when the hub rejects it, and when there is no connection", () => {
  const onEnd = vi.fn();
  const send = () =>
    hub.sendGoal({ action: "/a", type: "a/A", values: {} }, () => undefined, onEnd);
  send();
  open();
  send();
  receive({ op: "status", id: take("send_action_goal")[0]?.id, level: "error", msg: "no" });
  send();
  close();
  expect(onEnd.mock.calls.map(([end]) => [end.status, end.result])).toEqual([
    [0, false],
    [6, false],
    [0, false],
  ]);
});

test("failed attempts to connect are counted until one succeeds", () => {
  close(1006, "");
  vi.advanceTimersByTime(250);
  close(1006, "");
  expect(hub.failures.value).toBe(2);
  vi.advanceTimersByTime(500);
  open();
  expect(hub.failures.value).toBe(0);
  close();
  expect(hub.failures.value).toBe(0);
});

test("a call made before the connection opens is sent afterwards", async () => {
  const response = hub.call("/add", "a/Add", { a: 1 });
  expect(take("call_service")).toEqual([]);
  open();
  const [call] = take("call_service");
  expect(call).toMatchObject({ service: "/add", args: { a: 1 }, timeout: 60 });
  receive({ op: "service_response", id: call?.id, result: true, values: { sum: 3 } });
  await expect(response).resolves.toEqual({ sum: 3 });
});

test("a call fails with the text of the service or of the hub", async () => {
  open();
  const failed = hub.call("/add", "a/Add");
  const silent = hub.call("/add", "a/Add");
  const invalid = hub.call("/add", "a/Add");
  const [one, two, three] = take("call_service").map(({ id }) => id);
  receive({ op: "service_response", id: one, service: "/add", result: false, values: "overflow" });
  receive({ op: "service_response", id: two, service: "/add", result: false, values: "" });
  receive({ op: "status", id: three, level: "error", msg: "unknown service" });
  await expect(failed).rejects.toThrow("overflow");
  await expect(silent).rejects.toThrow("/add");
  await expect(invalid).rejects.toThrow("unknown service");
});

test("a call fails when it times out and when the connection is lost", async () => {
  open();
  const late = hub.call("/slow", "a/Slow", {}, 10);
  const timedOut = expect(late).rejects.toThrow(CallTimeout);
  await vi.advanceTimersByTimeAsync(12_001);
  await timedOut;
  const lost = hub.call("/slow", "a/Slow");
  close();
  await expect(lost).rejects.toThrow("connection was lost");
});

test("a response after the timeout is ignored", async () => {
  open();
  const late = hub.call("/slow", "a/Slow", {}, 10);
  const timedOut = expect(late).rejects.toThrow(CallTimeout);
  const [call] = take("call_service");
  await vi.advanceTimersByTimeAsync(12_001);
  await timedOut;
  expect(() =>
    receive({ op: "service_response", id: call?.id, result: true, values: {} }),
  ).not.toThrow();
});

test("advertisements are repeated after a reconnection", () => {
  open();
  hub.advertise("/gone", "a/T").close();
  hub.advertise("/mine", "a/T");
  close();
  expect(hub.state.value).toBe("closed");
  vi.advanceTimersByTime(250);
  open();
  expect(hub.state.value).toBe("open");
  expect(take("advertise")).toMatchObject([{ topic: "/mine" }]);
});

test("errors are reported to the caller of the operation", () => {
  open();
  const publisher = vi.fn();
  const publication = hub.advertise("/t", "a/T", publisher);
  const [advertise] = socket().sent.map(({ id }) => id);
  publication.publish({ data: 1 });
  expect(take("publish")).toMatchObject([{ id: advertise, topic: "/t", msg: { data: 1 } }]);
  receive({ op: "status", id: advertise, msg: "not this value" });
  expect(publisher.mock.calls).toEqual([["not this value"]]);
  close();
  publication.publish({ data: 2 });
  expect(publisher).toHaveBeenCalledTimes(2);
  publication.close();
});

test("the time between attempts doubles up to a maximum", () => {
  vi.spyOn(Math, "random").mockReturnValue(1);
  open();
  close();
  const waits: number[] = [];
  for (let n = 0; n < 8; n += 1) {
    const before = FakeSocket.all.length;
    let waited = 0;
    while (FakeSocket.all.length === before) {
      vi.advanceTimersByTime(50);
      waited += 50;
    }
    waits.push(waited);
    close(1006, "");
  }
  expect(waits).toEqual([250, 500, 1000, 2000, 4000, 4000, 4000, 4000]);
  expect(hub.reason.value).toBe("the hub is shutting down");
});

test.each([1001, 1006, 1012])("pages come back at different times after code %i", (code) => {
  const attempts = [0, 0.5, 1].map((random) => {
    vi.spyOn(Math, "random").mockReturnValue(random);
    vi.clearAllTimers();
    FakeSocket.all = [];
    hub = new Hub("ws://hub/");
    open();
    close(code, "service restart");
    vi.advanceTimersByTime(200);
    return FakeSocket.all.length - 1;
  });
  expect(attempts).toEqual([1, 0, 0]);
  vi.advanceTimersByTime(50);
  expect(FakeSocket.all).toHaveLength(2);
});

test("the page does not reconnect by itself after a shutdown request", () => {
  open();
  close(4002, "shutdown request");
  expect(hub.ended.value).toBe(true);
  vi.advanceTimersByTime(60_000);
  expect(FakeSocket.all).toHaveLength(1);
  hub.connect();
  open();
  expect(hub.ended.value).toBe(false);
});

test("a connection that no longer responds is replaced", () => {
  open();
  const dead = socket();
  hub.drop("no response");
  expect(hub.state.value).toBe("closed");
  expect(hub.reason.value).toBe("no response");
  expect(dead.closed).toBe(true);
  vi.advanceTimersByTime(250);
  expect(FakeSocket.all).toHaveLength(2);
  open();
  expect([dead.onmessage, dead.onclose]).toEqual([null, null]);
  expect(hub.state.value).toBe("open");
});

test("an address that the browser rejects is reported and not tried again", () => {
  const broken = new Hub("ws://two words/");
  expect(broken.state.value).toBe("closed");
  expect(broken.reason.value).toContain("two words");
  expect(broken.ended.value).toBe(true);
});

test.each([
  ["robot", "ws://robot:9090/"],
  ["robot:9191", "ws://robot:9191/"],
  ["localhost:9090", "ws://localhost:9090/"],
  ["robot:80", "ws://robot/"],
  ["[::1]", "ws://[::1]:9090/"],
  [" 10.0.0.1:1/lab ", "ws://10.0.0.1:1/lab"],
  ["ws://robot", "ws://robot/"],
  ["wss://robot:443/lab?token=1", "wss://robot/lab?token=1"],
])("the address %s is %s", (address, url) => {
  expect(hubUrl(address)).toBe(url);
});

test("addresses without a scheme are secure on a secure page", () => {
  expect(hubUrl("robot", true)).toBe("wss://robot:9090/");
});

test.each(["two words", "http://robot", "ws://", "9090", "robot:0", "ws://robot/#x", "a:b"])(
  "the address %s is invalid",
  (address) => {
    expect(() => hubUrl(address)).toThrow(address);
  },
);

test("the default hub is on this machine at port 9090", () => {
  expect(isDefaultHub("ws://localhost:9090/")).toBe(true);
  expect(isDefaultHub("ws://localhost:9091/")).toBe(false);
  expect(isDefaultHub("ws://robot:9090/")).toBe(false);
});

test("the node's name is added to the address's query", () => {
  expect(withNode("ws://robot/?token=1", "/page_1")).toBe("ws://robot/?token=1&node=/page_1");
});

test("a page without a token is denied, and does not reconnect", () => {
  open();
  expect(hub.denied.value).toBe("");
  close(4401, "missing token");
  expect([hub.denied.value, hub.ended.value]).toEqual(["missing token", true]);
  vi.runAllTimers();
  expect(FakeSocket.all).toHaveLength(1);
  hub.connect();
  open();
  expect([hub.denied.value, hub.ended.value]).toEqual(["", false]);
});

test.each([
  [1000, true],
  [1001, true],
  [1006, true],
  [1008, true],
  [1009, true],
  [1011, true],
  [1012, true],
  [1013, true],
  [4001, false],
  [4002, false],
  [4401, false],
  [4403, false],
  [4429, true],
])("after the close code %i a page tries again: %s", (code, again) => {
  open();
  close(code, "why");
  vi.runOnlyPendingTimers();
  expect([FakeSocket.all.length, hub.ended.value]).toEqual([again ? 2 : 1, !again]);
});

test("another reason to stop does not ask for a token", () => {
  open();
  close(4403, "missing right node for /page");
  expect([hub.denied.value, hub.ended.value]).toEqual(["", true]);
});

test("a denied page is disconnected", () => {
  open();
  const first = socket();
  hub.deny("missing token");
  expect([first.closed, hub.state.value, hub.denied.value]).toEqual([
    true,
    "closed",
    "missing token",
  ]);
});

test("the token comes first on each connection, and is not in the address", () => {
  hub.advertise("/a", "a/T");
  hub.enter("secret");
  open();
  expect(socket().sent.map(({ op }) => op)).toEqual(["auth", "advertise"]);
  expect(socket().sent[0]).toMatchObject({ token: "secret" });
  expect(socket().url).not.toContain("secret");
});

test("the token of an address is taken out of it", () => {
  expect(splitToken("ws://robot:9090/?a=b&token=x%2By")).toEqual({
    url: "ws://robot:9090/?a=b",
    token: "x+y",
  });
  expect(splitToken("ws://robot:9090/")).toEqual({ url: "ws://robot:9090/", token: "" });
});

test("a connection that is not open yet is closed as soon as it is", () => {
  const first = Object.assign(socket(), { readyState: 0 });
  hub.deny("missing token");
  expect(first.closed).toBe(false);
  first.onopen?.();
  expect([first.closed, hub.state.value]).toEqual([true, "closed"]);
});
