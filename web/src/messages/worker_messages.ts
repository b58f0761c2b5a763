/** What the page and the worker of its second connection say to each other about messages. */
import type { Delivery, Subscription } from "./feed";

export type Request =
  | { kind: "connect"; url: string; token: string }
  /** Disconnect until the next `connect`: the page has logged out. */
  | { kind: "disconnect" }
  /** Subscribe; messages come in batches: the next one after `taken`. */
  | ({ kind: "messages"; id: number } & Subscription)
  | { kind: "taken"; id: number }
  | { kind: "close"; id: number };

export type Report =
  /** The arrays of the messages are the page's own. */
  | { kind: "messages"; id: number; batch: readonly Delivery[] }
  /** The hub has subscribed. */
  | { kind: "ready"; id: number }
  | { kind: "fault"; id: number; why: string };
