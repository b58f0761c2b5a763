/** What the page and the worker say to each other about point clouds. */
import type { Delivery } from "../../messages/feed";
import type { Coloring, Packed } from "./cloud";
import type { Header } from "./layer";

/** The choice of colours, and how many points are shown at most. */
export type Options = Coloring & { readonly most: number };

export type Request =
  | {
      kind: "cloud";
      id: number;
      topic: string;
      type: string;
      throttle: number;
      options: Options;
    }
  /** `isAgain`: prepare the newest cloud again. */
  | { kind: "options"; id: number; options: Options; isAgain: boolean }
  | { kind: "taken"; id: number }
  | { kind: "close"; id: number };

export type Report =
  /** A cloud, whose bytes are the page's own; `isAgain`: the newest one, in other colours. */
  | ({
      kind: "cloud";
      id: number;
      message: { header: Header; packed: Packed };
      isAgain: boolean;
    } & Omit<Delivery, "message">)
  | { kind: "fault"; id: number; why: string };
