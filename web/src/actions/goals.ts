/**
 * Sending goals of actions, and following them: over topics as in ROS 1, or over operations.
 *
 * Source: http://wiki.ros.org/actionlib/DetailedDescription. ROS 2 has fewer statuses
 * (action_msgs/GoalStatus); each has the name of one of actionlib here.
 */
import type { Message, Publication } from "../hub";
import { subscribe } from "../messages/data_client";
import { type Signal, Source } from "../signal";
import type { DataSource } from "../source";
import { own } from "../types";

/** The names of the statuses, at the numbers of actionlib_msgs/GoalStatus. */
const STATUSES = [
  "PENDING",
  "ACTIVE",
  "PREEMPTED",
  "SUCCEEDED",
  "ABORTED",
  "REJECTED",
  "PREEMPTING",
  "RECALLING",
  "RECALLED",
  "LOST",
] as const;
export type Status = (typeof STATUSES)[number];

/** The same at the numbers of ROS 2. */
const ROS2_STATUSES: readonly Status[] = [
  "LOST",
  "PENDING",
  "ACTIVE",
  "PREEMPTING",
  "SUCCEEDED",
  "PREEMPTED",
  "ABORTED",
];
const UNFINISHED: ReadonlySet<Status> = new Set(["PENDING", "ACTIVE", "PREEMPTING", "RECALLING"]);

/** Time without a message about a goal, or from its server, after which it is lost, in ms. */
const LOST_AFTER = 5000;
/** How long goals wait for the hub to subscribe to the action's topics, in ms. */
const READY_AFTER = 1000;
/** How many messages of each topic the hub queues while the page falls behind. */
const QUEUE = 100;

/** What is known about a goal. */
export interface Progress {
  readonly status: Status;
  /** What the server says about the status. */
  readonly text: string;
  /** The newest feedback. */
  readonly feedback: Message | undefined;
  readonly feedbackCount: number;
  readonly result: Message | undefined;
}

const SENT: Progress = {
  status: "PENDING",
  text: "",
  feedback: undefined,
  feedbackCount: 0,
  result: undefined,
};

export function isFinal(status: Status): boolean {
  return !UNFINISHED.has(status);
}

/** One goal, from the moment when it is sent. */
export class Goal {
  readonly values: Message;
  readonly progress: Signal<Progress>;
  readonly cancel: () => void;
  readonly #progress = new Source(SENT);

  constructor(values: Message, cancel: () => void) {
    this.values = values;
    this.progress = this.#progress;
    this.cancel = cancel;
  }

  get isFinal(): boolean {
    return isFinal(this.#progress.value.status);
  }

  /** The status has changed; a final one stays. */
  setStatus(status: Status, text = ""): void {
    const { value } = this.#progress;
    if (this.isFinal || (value.status === status && value.text === text)) return;
    this.#progress.set({ ...value, status, text });
  }

  addFeedback(feedback: Message): void {
    const { value } = this.#progress;
    if (this.isFinal) return;
    this.#progress.set({ ...value, feedback, feedbackCount: value.feedbackCount + 1 });
  }

  /** The goal has ended. The result may come after the final status. */
  end(status: Status, text: string, result: Message | undefined): void {
    const { value } = this.#progress;
    if (value.result === undefined) this.#progress.set({ ...value, status, text, result });
  }
}

/** Sends the goals of one action. */
export interface GoalSender {
  send(values: Message): Goal;
  /** Stop following the goals. */
  close(): void;
}

/** Sends goals by the operations that rosbridge has for ROS 2. */
export class OperationSender implements GoalSender {
  readonly #hub: DataSource;
  readonly #action: string;
  readonly #type: string;

  constructor(hub: DataSource, action: string, type: string) {
    this.#hub = hub;
    this.#action = action;
    this.#type = type;
  }

  send(values: Message): Goal {
    const goal = new Goal(values, () => {
      goal.setStatus("PREEMPTING");
      cancel();
    });
    const cancel = this.#hub.sendGoal(
      { action: this.#action, type: this.#type, values },
      (feedback) => {
        if (goal.progress.value.status === "PENDING") goal.setStatus("ACTIVE");
        goal.addFeedback(feedback);
      },
      ({ status, result, values: end }) => {
        const name = ROS2_STATUSES[status] ?? "LOST";
        if (result) goal.end(name, "", messageOf(end));
        else goal.end(isFinal(name) ? name : "ABORTED", String(end ?? ""), undefined);
      },
    );
    return goal;
  }

  close(): void {
    // Each goal ends with a result by itself.
  }
}

/** Sends goals over the five topics of an action in ROS 1. */
export class TopicSender implements GoalSender {
  readonly #hub: DataSource;
  readonly #now: () => number;
  readonly #goals = new Map<string, Followed>();
  readonly #goalTopic: Publication;
  readonly #cancelTopic: Publication;
  readonly #unsubscribe: (() => void)[];
  readonly #timer: number;
  readonly #readyTimer: number;
  /** The topics to which the hub has not subscribed yet, and the goals that wait for that. */
  readonly #missing = new Set(["status", "feedback", "result"]);
  readonly #unsent: (() => void)[] = [];
  #count = 0;

  /** `now` returns the time in ms since 1970. */
  constructor(hub: DataSource, action: string, type: string, now: () => number = Date.now) {
    this.#hub = hub;
    this.#now = now;
    const follow = (topic: string, listener: (message: Message) => void): (() => void) =>
      subscribe(
        hub,
        { topic: `${action}/${topic}`, queue: QUEUE },
        listener,
        (why) => why !== "" && hub.state.value === "open" && this.#reject(why),
        () => this.#setReady(topic),
      );
    const advertise = (topic: string, topicType: string): Publication =>
      hub.advertise(`${action}/${topic}`, topicType, (why) => this.#reject(why));
    this.#unsubscribe = [
      follow("status", (message) => this.#onStatus(message)),
      follow("feedback", (message) => this.#onFeedback(message)),
      follow("result", (message) => this.#onResult(message)),
    ];
    this.#cancelTopic = advertise("cancel", "actionlib_msgs/GoalID");
    this.#goalTopic = advertise("goal", `${type}ActionGoal`);
    this.#timer = window.setInterval(() => this.#findLost(), LOST_AFTER / 5);
    // A topic that nobody uses has no type yet, of which the hub would tell.
    this.#readyTimer = window.setTimeout(() => this.#sendAll(), READY_AFTER);
  }

  send(values: Message): Goal {
    this.#count += 1;
    const now = this.#now();
    const id = `${this.#hub.node}-${this.#count}-${(now / 1000).toFixed(3)}`;
    const goal = new Goal(values, () => {
      const followed = this.#goals.get(id);
      if (followed !== undefined) followed.lastHeard = this.#now();
      // With a stamp, all goals before it would be canceled.
      this.#cancelTopic.publish({ stamp: { secs: 0, nsecs: 0 }, id });
    });
    this.#goals.set(id, { goal, lastHeard: now, isConfirmed: false });
    const stamp = { secs: Math.floor(now / 1000), nsecs: Math.floor(now % 1000) * 1_000_000 };
    const publish = (): void => this.#goalTopic.publish({ goal_id: { stamp, id }, goal: values });
    if (this.#missing.size === 0) publish();
    else this.#unsent.push(publish);
    return goal;
  }

  /** The hub has subscribed to a topic: once it has to all, no message about a goal can be missed. */
  #setReady(topic: string): void {
    this.#missing.delete(topic);
    if (this.#missing.size === 0) this.#sendAll();
  }

  #sendAll(): void {
    this.#missing.clear();
    for (const publish of this.#unsent.splice(0)) publish();
  }

  close(): void {
    window.clearInterval(this.#timer);
    window.clearTimeout(this.#readyTimer);
    for (const stop of this.#unsubscribe) stop();
    this.#goalTopic.close();
    this.#cancelTopic.close();
  }

  #onStatus({ status_list }: Message): void {
    const statuses = new Map<unknown, unknown>();
    if (Array.isArray(status_list)) for (const each of status_list) statuses.set(idOf(each), each);
    for (const [id, followed] of this.#goals) {
      const status = statuses.get(id);
      if (status !== undefined) this.#confirm(followed, status);
      // It may wait in the server's queue.
      else if (!followed.isConfirmed) followed.lastHeard = this.#now();
    }
  }

  #onFeedback({ status, feedback }: Message): void {
    const followed = this.#goals.get(idOf(status));
    if (followed === undefined) return; // Another client's goal.
    this.#confirm(followed, status);
    followed.goal.addFeedback(messageOf(feedback));
  }

  #onResult({ status, result }: Message): void {
    const id = idOf(status);
    this.#goals.get(id)?.goal.end(statusOf(status), textOf(status), messageOf(result));
    this.#goals.delete(id);
  }

  /** Note that the server has mentioned the goal. */
  #confirm(followed: Followed, status: unknown): void {
    followed.isConfirmed = true;
    followed.lastHeard = this.#now();
    followed.goal.setStatus(statusOf(status), textOf(status));
  }

  /** The hub has rejected a subscription, an advertisement or a message. */
  #reject(why: string): void {
    for (const [id, { goal, isConfirmed }] of this.#goals) {
      if (isConfirmed) continue;
      goal.end("REJECTED", why, undefined);
      this.#goals.delete(id);
    }
  }

  #findLost(): void {
    const now = this.#now();
    for (const [id, followed] of this.#goals) {
      // Nothing arrives without a connection.
      if (this.#hub.state.value !== "open") followed.lastHeard = now;
      if (now - followed.lastHeard < LOST_AFTER) continue;
      const text = `no message about the goal for ${LOST_AFTER / 1000} s`;
      followed.goal.setStatus("LOST", text);
      this.#goals.delete(id);
    }
  }
}

interface Followed {
  readonly goal: Goal;
  /** When the goal, or its server before it mentioned the goal, was last heard of. */
  lastHeard: number;
  /** Whether the server has mentioned the goal. */
  isConfirmed: boolean;
}

/** The goal's id in an actionlib_msgs/GoalStatus. */
function idOf(status: unknown): string {
  return String(own(own(status, "goal_id"), "id"));
}

function statusOf(status: unknown): Status {
  return STATUSES[Number(own(status, "status"))] ?? "LOST";
}

function textOf(status: unknown): string {
  return String(own(status, "text") ?? "");
}

function messageOf(values: unknown): Message {
  return typeof values === "object" && values !== null ? (values as Message) : {};
}
