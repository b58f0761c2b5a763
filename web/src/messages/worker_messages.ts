/** What the page and the worker of its second connection say to each other. */
import type { PictureState } from "../panels/image/picture";
import type { Options } from "../panels/image/pixels";
import type { TypeDef } from "../types";
import type { Fields } from "./reader";

/** A subscription to whole messages. */
export interface Subscription {
  readonly topic: string;
  /** The definition of the topic's type, which comes first. */
  readonly typedefs: readonly TypeDef[];
  /** The least time between two messages, in ms. */
  readonly throttle: number;
  /** How many messages wait while one is processed; of more, the oldest are skipped. */
  readonly queue: number;
}

export type Request =
  | { kind: "connect"; url: string; token: string }
  /** Disconnect until the next `connect`: the page has logged out. */
  | { kind: "disconnect" }
  | {
      kind: "picture";
      id: number;
      canvas: OffscreenCanvas;
      topic: string;
      typedefs: readonly TypeDef[];
      throttle: number;
    }
  /** Subscribe to whole messages, which come one at a time: the next after `taken`. */
  | ({ kind: "messages"; id: number } & Subscription)
  | { kind: "taken"; id: number }
  /** Subscribe again with another throttle, in ms; null pauses. */
  | { kind: "throttle"; id: number; throttle: number | null }
  | { kind: "options"; id: number; options: Options }
  /** Request the value of a pixel. */
  | { kind: "value"; id: number; x: number; y: number }
  /** Request the picture as a file. */
  | { kind: "file"; id: number }
  | { kind: "close"; id: number };

export type Report =
  | { kind: "state"; id: number; state: PictureState }
  /** The arrays of a message are the page's own. */
  | { kind: "message"; id: number; message: Fields }
  | { kind: "fault"; id: number; why: string }
  | { kind: "value"; id: number; x: number; y: number; text: string }
  | { kind: "file"; id: number; file: Blob };
