import { afterEach, beforeEach, expect, test, vi } from "vitest";

import type { GoalEnd, Message } from "../hub";
import { Source } from "../signal";
import type { DataSource } from "../source";
import { OperationSender, TopicSender } from "./goals";

vi.mock("../messages/data_client", () => ({
  subscribe: (fake: FakeHub, ...rest: Parameters<FakeHub["subscribe"]>) => fake.subscribe(...rest),
}));

/** Stands in for the connection: records what is published, and the test sends messages. */
class FakeHub {
  readonly node = "/page_1";
  readonly state = new Source("open");
  readonly published: [topic: string, message: Message][] = [];
  readonly open = new Set<string>();
  readonly canceled: string[] = [];
  onFeedback: (feedback: Message) => void = () => undefined;
  onEnd: (end: GoalEnd) => void = () => undefined;
  reject: (why: string) => void = () => undefined;
  readonly #listeners = new Map<string, (message: Message) => void>();

  /** Whether the hub subscribes at once. */
  isReady = true;
  readonly subscribed: (() => void)[] = [];

  subscribe(
    { topic }: { topic: string },
    listener: (message: Message) => void,
    _fail: (why: string) => void,
    ready: () => void,
  ): () => void {
    this.#listeners.set(topic, listener);
    this.open.add(topic);
    if (this.isReady) ready();
    else this.subscribed.push(ready);
    return () => this.open.delete(topic);
  }

  advertise(topic: string, type: string, onError: (why: string) => void) {
    this.open.add(`${topic} ${type}`);
    this.reject = onError;
    return {
      publish: (message: Message) => this.published.push([topic, message]),
      close: () => this.open.delete(`${topic} ${type}`),
    };
  }

  sendGoal(
    request: { action: string },
    onFeedback: (feedback: Message) => void,
    onEnd: (end: GoalEnd) => void,
  ): () => void {
    this.onFeedback = onFeedback;
    this.onEnd = onEnd;
    return () => this.canceled.push(request.action);
  }

  receive(topic: string, message: Message): void {
    this.#listeners.get(topic)?.(message);
  }

  /** The id of the newest goal. */
  get id(): string {
    const goals = this.published.filter(([topic]) => topic === "/count/goal");
    const newest = goals.at(-1)?.[1].goal_id as { id: string } | undefined;
    return newest?.id ?? "no goal was sent";
  }
}

let fake: FakeHub;
let hub: DataSource;
let sender: TopicSender;

const status = (number: number, text = "", id = fake.id) => ({
  goal_id: { stamp: { secs: 0, nsecs: 0 }, id },
  status: number,
  text,
});
const receiveStatus = (...status_list: object[]) => fake.receive("/count/status", { status_list });

beforeEach(() => {
  vi.useFakeTimers({ now: 1_700_000_000_125 });
  vi.stubGlobal("window", globalThis);
  fake = new FakeHub();
  hub = fake as unknown as DataSource;
  sender = new TopicSender(hub, "/count", "a/Count");
});
afterEach(() => {
  sender.close();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("a goal over topics has an id and a stamp of its own", () => {
  sender.send({ to: 8 });
  sender.send({ to: 9 });
  expect(fake.published[0]).toEqual([
    "/count/goal",
    {
      goal_id: {
        id: "/page_1-1-1700000000.125",
        stamp: { secs: 1_700_000_000, nsecs: 125_000_000 },
      },
      goal: { to: 8 },
    },
  ]);
  expect(fake.id).toBe("/page_1-2-1700000000.125");
  expect(fake.open).toContain("/count/goal a/CountActionGoal");
});

test("a goal over topics has status, feedback and result", () => {
  const goal = sender.send({ to: 8 });
  expect(goal.progress.value.status).toBe("PENDING");
  receiveStatus(status(1, "counting"));
  expect(goal.progress.value).toMatchObject({ status: "ACTIVE", text: "counting" });
  for (const at of [1, 2]) {
    fake.receive("/count/feedback", { status: status(1), feedback: { at } });
  }
  expect(goal.progress.value).toMatchObject({ feedback: { at: 2 }, feedbackCount: 2 });
  receiveStatus(status(3, "done"));
  fake.receive("/count/result", { status: status(3, "done"), result: { sum: 36 } });
  expect(goal.progress.value).toMatchObject({ status: "SUCCEEDED", result: { sum: 36 } });
  receiveStatus(status(1));
  expect(goal.progress.value.status).toBe("SUCCEEDED");
});

test("messages about goals of other clients are ignored", () => {
  const goal = sender.send({});
  fake.receive("/count/feedback", { status: status(1, "", "/other-1"), feedback: { at: 1 } });
  fake.receive("/count/result", { status: status(3, "", "/other-1"), result: {} });
  expect(goal.progress.value).toMatchObject({ status: "PENDING", feedbackCount: 0 });
});

test("each of several goals gets its own messages", () => {
  const first = sender.send({});
  const id = fake.id;
  const second = sender.send({});
  receiveStatus(status(4, "no", id), status(1));
  expect(first.progress.value.status).toBe("ABORTED");
  expect(second.progress.value.status).toBe("ACTIVE");
});

test("canceling names only the goal, without a time that would cancel others", () => {
  const goal = sender.send({});
  goal.cancel();
  expect(fake.published.at(-1)).toEqual([
    "/count/cancel",
    { id: fake.id, stamp: { secs: 0, nsecs: 0 } },
  ]);
});

test("a goal that the hub rejects ends, and one that runs does not", () => {
  const running = sender.send({});
  receiveStatus(status(1));
  const rejected = sender.send({});
  fake.reject("to must be a number");
  expect(rejected.progress.value).toMatchObject({
    status: "REJECTED",
    text: "to must be a number",
  });
  expect(running.progress.value.status).toBe("ACTIVE");
});

test("a goal is lost once its server has been silent for 5 s", () => {
  const goal = sender.send({});
  vi.advanceTimersByTime(4000);
  receiveStatus();
  vi.advanceTimersByTime(4000);
  expect(goal.progress.value.status).toBe("PENDING");
  vi.advanceTimersByTime(2000);
  expect(goal.progress.value.status).toBe("LOST");
});

test("a goal that its server no longer mentions is lost", () => {
  const goal = sender.send({});
  receiveStatus(status(1));
  for (let second = 0; second < 6; second += 1) {
    vi.advanceTimersByTime(1000);
    receiveStatus();
  }
  expect(goal.progress.value.status).toBe("LOST");
});

test("no goal is lost while the page is not connected", () => {
  const goal = sender.send({});
  fake.state.set("closed");
  vi.advanceTimersByTime(60_000);
  expect(goal.progress.value.status).toBe("PENDING");
});

test("closing takes all subscriptions and advertisements back", () => {
  expect(fake.open.size).toBe(5);
  sender.close();
  expect(fake.open.size).toBe(0);
});

test("a goal over operations has feedback and a result", () => {
  const goal = new OperationSender(hub, "/count", "a/action/Count").send({ to: 8 });
  fake.onFeedback({ at: 1 });
  expect(goal.progress.value).toMatchObject({ status: "ACTIVE", feedback: { at: 1 } });
  goal.cancel();
  expect(fake.canceled).toEqual(["/count"]);
  fake.onFeedback({ at: 2 });
  expect(goal.progress.value.status).toBe("PREEMPTING");
  fake.onEnd({ status: 5, result: true, values: { sum: 3 } });
  expect(goal.progress.value).toMatchObject({ status: "PREEMPTED", result: { sum: 3 } });
});

test.each([
  [{ status: 6, result: false, values: "unknown action" }, "ABORTED", "unknown action"],
  [{ status: 5, result: false, values: "stopped" }, "PREEMPTED", "stopped"],
  [{ status: 0, result: false, values: "connection lost" }, "LOST", "connection lost"],
  [{ status: 2, result: false, values: null }, "ABORTED", ""],
])("the end %j of a goal over operations is %s", (end, name, text) => {
  const goal = new OperationSender(hub, "/count", "a/Count").send({});
  fake.onEnd(end);
  expect(goal.progress.value).toMatchObject({ status: name, text, result: undefined });
});

test("a goal is sent once the hub has subscribed to all that is told about it", () => {
  sender.close();
  fake.isReady = false;
  sender = new TopicSender(hub, "/count", "a/Count");
  sender.send({ to: 8 });
  const sent = () => fake.published.map(([topic]) => topic);
  expect(sent()).toEqual([]);
  for (const ready of fake.subscribed) ready();
  expect(sent()).toEqual(["/count/goal"]);
});

test("a goal is sent although nobody uses the topics about it", () => {
  sender.close();
  fake.isReady = false;
  sender = new TopicSender(hub, "/count", "a/Count");
  sender.send({ to: 8 });
  vi.advanceTimersByTime(1000);
  expect(fake.published.map(([topic]) => topic)).toEqual(["/count/goal"]);
});
