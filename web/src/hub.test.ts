import type { Ros } from "roslib";
import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { Hub, NoAnswer } from "./hub";

type Operation = Record<string, unknown>;

/** Stands for roslib's connection: the test opens and closes it, and says what the hub says. */
class Connection {
  readonly sent: Operation[] = [];
  attempts = 0;
  readonly #listeners = new Map<string, ((what: unknown) => void)[]>();

  on(event: string, listener: (what: unknown) => void): void {
    this.#listeners.set(event, [...(this.#listeners.get(event) ?? []), listener]);
  }

  off(event: string): void {
    this.#listeners.delete(event);
  }

  emit(event: string, what: unknown): void {
    for (const listener of this.#listeners.get(event) ?? []) listener(what);
  }

  connect(): Promise<void> {
    this.attempts += 1;
    return Promise.resolve();
  }

  close(): void {
    this.emit("close", { code: 1006, reason: "" });
  }

  callOnConnection(operation: Operation): void {
    this.sent.push(operation);
  }

  /** The operations of one kind since the last time that one asked. */
  take(op: string): Operation[] {
    const taken = this.sent.filter((operation) => operation.op === op);
    this.sent.length = 0;
    return taken;
  }
}

let connection: Connection;
let hub: Hub;

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("window", globalThis);
  connection = new Connection();
  hub = new Hub("ws://hub", connection as unknown as Ros);
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

function open(): void {
  connection.emit("connection", {});
}

function close(code = 1001, reason = "the hub is shutting down"): void {
  connection.emit("close", { code, reason });
}

test("a call that is made before the hub is there is sent once it is", async () => {
  const answer = hub.call("/add", "a/Add", { a: 1 });
  expect(connection.take("call_service")).toEqual([]);
  open();
  const [call] = connection.take("call_service");
  expect(call).toMatchObject({ service: "/add", args: { a: 1 } });
  connection.emit(call?.id as string, { result: true, values: { sum: 3 } });
  await expect(answer).resolves.toEqual({ sum: 3 });
});

test("a call fails with the text of who refused it", async () => {
  open();
  const refused = hub.call("/add", "a/Add");
  const invalid = hub.call("/add", "a/Add");
  const [one, other] = connection.take("call_service");
  connection.emit(one?.id as string, { result: false, values: "no such service" });
  connection.emit(`status:${String(other?.id)}`, { level: "error", msg: "no such operation" });
  await expect(refused).rejects.toThrow("no such service");
  await expect(invalid).rejects.toThrow("no such operation");
});

test("a call fails when its time is over, and when the connection is lost", async () => {
  open();
  const late = hub.call("/slow", "a/Slow", {}, 10);
  const told = expect(late).rejects.toThrow(NoAnswer);
  await vi.advanceTimersByTimeAsync(12_001);
  await told;
  const lost = hub.call("/slow", "a/Slow");
  close();
  await expect(lost).rejects.toThrow("The connection was lost");
});

test("what was subscribed to and advertised comes back with the connection", () => {
  open();
  const stop = hub.subscribe("/gone", {}, () => undefined);
  hub.subscribe("/kept", { throttle: 100, queue: 1 }, () => undefined);
  hub.advertise("/mine", "a/T");
  stop();
  connection.sent.length = 0;
  close();
  expect(hub.state.value).toBe("closed");
  open();
  expect(hub.state.value).toBe("open");
  const [subscribe, ...more] = connection.sent.filter(({ op }) => op === "subscribe");
  expect(more).toEqual([]);
  expect(subscribe).toMatchObject({ topic: "/kept", throttle_rate: 100, queue_length: 1 });
  // It would keep nodes from giving the topic another type.
  expect(subscribe).not.toHaveProperty("type");
  expect(connection.take("advertise")).toMatchObject([{ topic: "/mine" }]);
});

test("each listener of a topic hears it until it leaves, and the last leaves the hub", () => {
  open();
  const [one, other] = [vi.fn(), vi.fn()];
  const stopOne = hub.subscribe("/t", {}, one);
  const stopOther = hub.subscribe("/t", {}, other);
  const ids = connection.take("subscribe").map(({ id }) => id);
  expect(new Set(ids).size).toBe(2);
  connection.emit("/t", { msg: { data: 1 } });
  stopOne();
  stopOne();
  connection.emit("/t", { msg: { data: 2 } });
  expect(one.mock.calls).toEqual([[{ data: 1 }]]);
  expect(other.mock.calls).toEqual([[{ data: 1 }], [{ data: 2 }]]);
  expect(connection.take("unsubscribe")).toMatchObject([{ id: ids[0] }]);
  stopOther();
  expect(connection.take("unsubscribe")).toMatchObject([{ id: ids[1] }]);
});

test("what the hub refuses is told to whoever asked for it", () => {
  open();
  const [deaf, mute] = [vi.fn(), vi.fn()];
  hub.subscribe("/t", {}, () => undefined, deaf);
  const publication = hub.advertise("/t", "a/T", mute);
  const [subscribe, advertise] = connection.sent;
  connection.emit(`status:${String(subscribe?.id)}`, { msg: "not this type" });
  publication.publish({ data: 1 });
  connection.emit(`status:${String(advertise?.id)}`, { msg: "not this value" });
  expect(deaf.mock.calls).toEqual([["not this type"]]);
  expect(mute.mock.calls).toEqual([["not this value"]]);
  close();
  publication.publish({ data: 2 });
  expect(mute).toHaveBeenCalledTimes(2);
});

test("attempts to come back are made at longer and longer intervals, but not for ever longer", () => {
  close();
  const pauses: number[] = [];
  for (let n = 0; n < 8; n += 1) {
    const before = connection.attempts;
    let waited = 0;
    while (connection.attempts === before) {
      vi.advanceTimersByTime(50);
      waited += 50;
    }
    pauses.push(waited);
    close(1006, "");
  }
  expect(pauses).toEqual([250, 500, 1000, 2000, 4000, 4000, 4000, 4000]);
  expect(hub.reason.value).toBe("the hub is shutting down");
});

test("a page that was told to end does not come back by itself", () => {
  open();
  close(4002, "shutdown request");
  expect(hub.ended.value).toBe(true);
  vi.advanceTimersByTime(60_000);
  expect(connection.attempts).toBe(1);
  hub.connect();
  open();
  expect(hub.ended.value).toBe(false);
});

test("a connection on which nothing comes back is given up", () => {
  open();
  hub.drop("it does not answer");
  expect(hub.state.value).toBe("closed");
  expect(hub.reason.value).toBe("it does not answer");
  vi.advanceTimersByTime(250);
  expect(connection.attempts).toBe(2);
});
