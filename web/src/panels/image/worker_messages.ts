/** What the page and the worker say to each other about pictures. */
import type { PictureState } from "./picture";
import type { Options } from "./pixels";

export type Request =
  | {
      kind: "picture";
      id: number;
      canvas: OffscreenCanvas;
      topic: string;
      type: string;
      throttle: number;
    }
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
  | { kind: "fault"; id: number; why: string }
  | { kind: "value"; id: number; x: number; y: number; text: string }
  | { kind: "file"; id: number; file: Blob };
