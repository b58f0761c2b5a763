/** What the page and the worker of its second connection say to each other about messages. */
import type { Playback } from "../clock";
import type { Delivery, Subscription } from "./feed";
import type { Command } from "./player";

export type Request =
  | { kind: "connect"; url: string; token: string }
  /** Disconnect until the next `connect`: the page has logged out. */
  | { kind: "disconnect" }
  /** Keep messages from now on. */
  | { kind: "keep" }
  /** Show another time. */
  | { kind: "playback"; command: Command }
  /** The page has processed a batch. */
  | { kind: "taken batch" }
  /** Subscribe: messages come in batches. */
  | ({ kind: "messages"; id: number } & Subscription)
  | { kind: "close"; id: number };

export type Report =
  /** The arrays of the message are the page's own. */
  | { kind: "message"; id: number; delivery: Delivery }
  /** The hub has subscribed. */
  | { kind: "ready"; id: number }
  | { kind: "fault"; id: number; why: string };

/** Reports about messages of all streams, in their order; answered by `taken batch`. */
export interface Batch {
  readonly kind: "batch";
  readonly reports: readonly { readonly kind: string; readonly id: number }[];
}

/** About the time of all streams; those that follow a jump are of another moment. */
export type ClockReport = { kind: "jump" } | { kind: "clock"; playback: Playback };
