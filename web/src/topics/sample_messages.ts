/** What the page and the worker say to each other about the fields that are plotted. */
/** What is taken of each message. */
export type Wanted =
  /** A number or an array, as an expression. */
  | { readonly kind: "curve"; readonly text: string }
  /** A state: a boolean, a text, or an integer, some of which have names. */
  | { readonly kind: "states"; readonly path: string; readonly names: ReadonlyMap<bigint, string> };

/** From a time on, in seconds, the field had this state; `undefined` is a time without messages. */
export interface Change {
  readonly time: number;
  readonly state: string | undefined;
}

/** What the messages since the last piece had. */
export interface Piece {
  /** With the names of array elements once there was a message: `position[elbow]`. */
  readonly path: string;
  /** Whether time has gone back: what was before is of another run. */
  readonly isNew: boolean;
  /** Times in seconds and values, by turns. */
  readonly samples?: Float64Array;
  /** What is to be added to each value, as `RingBuffer.add` takes it; all 0 if this is missing. */
  readonly rests?: Float64Array | undefined;
  /** The newest elements of an array. */
  readonly elements?: Float64Array | undefined;
  readonly changes?: readonly Change[];
}

export type Request =
  | {
      kind: "samples";
      id: number;
      topic: string;
      /** How long before a moment is seen, in seconds. */
      span: number;
      wanted: readonly (readonly [key: number, Wanted])[];
    }
  /** Take something more of each message, beginning with the newest one. */
  | { kind: "add"; id: number; key: number; wanted: Wanted }
  | { kind: "remove"; id: number; key: number }
  | { kind: "close"; id: number };

export type Report =
  /** `missing`: a path at which the newest message had nothing to take; empty if there is none. */
  | {
      kind: "samples";
      id: number;
      pieces: readonly (readonly [key: number, Piece])[];
      missing: string;
    }
  | { kind: "fault"; id: number; why: string };
