/** Where the page's messages come from, as panels know it. */
import type { Hub } from "./hub";

/**
 * A source of messages, with a clock: a hub, live or some time ago, or a file.
 *
 * `open` streams messages from the worker, which `subscribe` of `messages/data_client` does for one
 * topic. Services, publications and goals need a hub: a file rejects them, with the reason. What
 * topics there are, and their types, is in the `Model` that belongs to the source.
 */
export type DataSource = Pick<
  Hub,
  | "url"
  | "node"
  | "state"
  | "clock"
  | "canPublish"
  | "isCongested"
  | "isOwn"
  | "second"
  | "open"
  | "call"
  | "advertise"
  | "sendGoal"
>;
