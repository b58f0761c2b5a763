/** What a layer of the scene is: it takes the messages of a topic, and draws them. */

import type { Wanted } from "../../messages/data_client";
import type { Fields } from "../../messages/reader";
import type { Graph, Model } from "../../model";
import type { DataSource } from "../../source";
import type { Transform, Vector } from "../../transforms";
import type { Camera, Spot } from "./camera";
import type { Color } from "./colors";
import { FrameError, frameName, type TransformBuffer } from "./tf_buffer";
import type { LayerId } from "./types";

export type Value = string | number | boolean;

/** The settings of a layer, by their names. They are saved with the scene. */
export type Settings = Record<string, Value>;

/** A setting that people change: a box to tick, a choice, a number, or a colour as `#rrggbb`. */
export interface Setting {
  readonly name: string;
  readonly label: string;
  /** The value at first, whose type is that of the setting. */
  readonly value: Value;
  /** The values of a choice. */
  readonly options?: readonly string[];
  /** Of a number. */
  readonly min?: number;
  readonly max?: number;
  readonly step?: number;
}

/** A kind of layer. The scene has one list of them. */
export interface LayerKind {
  /** Its name in saved layouts, which stays. */
  readonly id: LayerId;
  /** What it draws, in words: `Laser scan`. */
  readonly label: string;
  /** The types of topics that it draws. */
  readonly types: readonly string[];
  readonly settings: readonly Setting[];
  /** The least time between two messages, in ms. */
  readonly throttle: number;
  /** How many messages wait while one is processed, if none may be skipped. */
  readonly queue?: number;
  /** A message is expected again and again: say so if none has come for some seconds. */
  readonly isStream?: boolean;
  /** A message is an event, such as a goal, and has its age as it gets older. */
  readonly isEvent?: boolean;
  /** Another topic that changes what has been received: its messages go to `receiveUpdate`. */
  updates?(topic: string): { topic: string; type: string };
  /** Whether a scene that belongs to no topic begins with it. */
  readonly isFirst?: boolean;
  /** Whether it is shown with the layer of any topic, such as a map. */
  readonly isContext?: boolean;
  /** Whether it makes its own subscriptions, instead of taking messages by `receive`. */
  readonly isOwn?: boolean;
  /** Whether a topic of its types can be drawn; all can without this. */
  accepts?(topic: string): boolean;
  /** Names to offer besides the topics of its types; each is the `topic` of a layer. */
  offers?(graph: Graph): readonly string[];
  /** Make a layer, for which code may have to be loaded first. */
  make(context: LayerContext): Layer | Promise<Layer>;
}

export interface LayerContext {
  readonly hub: DataSource;
  readonly model: Model;
  readonly topic: string;
  readonly type: string;
  /** The current settings; the scene changes them, and then calls `update`. */
  readonly settings: Settings;
  readonly transforms: TransformBuffer;
  /** The picture has changed: draw it soon. */
  redraw(): void;
}

export interface Layer {
  /** Subscribe in place of the scene, to messages that the worker prepares; return how to end that. */
  subscribe?(
    wanted: Wanted,
    receive: (message: Fields) => void,
    fail: (why: string) => void,
  ): () => void;
  /** Take a message; throw an `Error` that says what is wrong with it. `now` is in ms since 1970. */
  receive?(message: Fields, now: number): void;
  /** Take a message of the kind's `updates`, none of which is skipped. */
  receiveUpdate?(message: Fields, now: number): void;
  /** Forget all messages, as far as the next one does not replace them. */
  clear?(): void;
  /** Draw what there is. */
  draw(view: View): void;
  /**
   * What is wrong with what it shows now.
   *
   * It is asked for again and again, also while nothing is drawn: keep no answer of `draw` for it.
   */
  problems(places: Places): Problems;
  /** What it shows, in words: `180 points, nearest 0.42 m at 12°`. */
  facts(places: Places): string;
  /** The settings have changed; throw an `Error` if they cannot be used. */
  update?(): void;
  /** What is under the pointer. */
  pick?(view: View, pointer: Pointer): Hit | undefined;
  /** Points of the fixed frame that a picture of everything has in it. */
  extent?(view: View): Vector[];
  /** Settings that depend on messages, such as namespaces, and their elements. */
  controls?(): HTMLElement | undefined;
  /** Update these elements, which are visible now. */
  updateControls?(places: Places): void;
  /** The scene is hidden, and shown again: own subscriptions end, and begin. */
  pause?(): void;
  resume?(): void;
  /** End: free what the graphics card keeps, and end own subscriptions. */
  close(): void;
}

/** A place on the picture, in CSS pixels. */
export interface Pointer {
  readonly x: number;
  readonly y: number;
}

/** Something under the pointer. */
export interface Hit {
  /** The distance to the pointer, in pixels. */
  readonly distance: number;
  /** What it is, in words. */
  readonly text: string;
  /** Where it is in the fixed frame. */
  readonly place?: Vector;
}

/** How far from the pointer something is still under it, in CSS pixels. */
export const REACH = 8;

export interface Stamp {
  readonly secs: number;
  readonly nsecs: number;
}

export interface Header {
  readonly stamp: Stamp;
  readonly frame_id: string;
}

/** Times that are further apart are worth a word, in ms. */
const APART = 500;

/** Text that is drawn at a place. */
export interface Label {
  readonly text: string;
  readonly spot: Spot;
  /** A CSS colour. */
  readonly color: string | undefined;
}

/** What is wrong with what a layer shows, in words; empty if nothing is. */
export interface Problems {
  /** Why it, or a part of it, is not shown. */
  readonly error: string;
  /** Why it may not be where it is shown. */
  readonly warning: string;
}

export const NO_PROBLEMS: Problems = { error: "", warning: "" };

/** The first error and the first warning of several parts. */
export function firstProblems(parts: Iterable<Problems>): Problems {
  let { error, warning } = NO_PROBLEMS;
  for (const part of parts) {
    error ||= part.error;
    warning ||= part.warning;
  }
  return { error, warning };
}

/** Where a frame is in the fixed frame, and what is wrong with that. */
export interface Place extends Problems {
  /** `undefined` if that is unknown, as the error says. */
  readonly transform: Transform | undefined;
}

/** The places of messages that stay the same, by their headers, and the fixed frame they are in. */
export type KnownPlaces = WeakMap<Header, { readonly target: string; readonly place: Place }>;

/** The places of frames in the fixed frame. */
export class Places {
  readonly fixedFrame: string;
  readonly #transforms: TransformBuffer;
  readonly #known: KnownPlaces;

  constructor(fixedFrame: string, transforms: TransformBuffer, known: KnownPlaces) {
    this.fixedFrame = fixedFrame;
    this.#transforms = transforms;
    this.#known = known;
  }

  /**
   * Where the frame of a message is at the time of its stamp.
   *
   * If tf does not have that time, it is the nearest one. Pass the message's own header, since what
   * has been found for it is kept.
   */
  locate(header: Header): Place {
    const known = this.#known.get(header);
    if (known?.target === this.fixedFrame) return known.place;
    const { secs, nsecs } = header.stamp;
    const { place, apart } = this.#lookup(header.frame_id, secs * 1000 + nsecs / 1e6);
    if (apart > APART) {
      const warning = `tf is ${(apart / 1000).toFixed(1)} s from the message's time`;
      return { ...place, warning };
    }
    if (apart === 0) this.#known.set(header, { target: this.fixedFrame, place });
    return place;
  }

  /** Where a frame is now. */
  locateNow(frame: string): Place {
    return this.#lookup(frame, 0).place;
  }

  /** As `locate`: where a layer draws a message. */
  place(header: Header): Transform | undefined {
    return this.locate(header).transform;
  }

  /** As `locateNow`: where a layer draws what moves with a frame. */
  placeNow(frame: string): Transform | undefined {
    return this.locateNow(frame).transform;
  }

  /** `apart` is how far the transforms are from the time, in ms; NaN if there are none. */
  #lookup(frame: string, stamp: number): { place: Place; apart: number } {
    const source = frameName(frame);
    const warning = source === "" ? `no frame_id: shown in ${this.fixedFrame}` : "";
    try {
      const { fixedFrame } = this;
      const { transform, apart } = this.#transforms.lookup(fixedFrame, source || fixedFrame, stamp);
      return { place: { transform, error: "", warning }, apart };
    } catch (error) {
      if (!(error instanceof FrameError)) throw error;
      return { place: { transform: undefined, error: error.message, warning }, apart: Number.NaN };
    }
  }
}

/** What a layer needs to draw one picture: the camera and the places of frames. */
export class View extends Places {
  readonly camera: Camera;
  /** Colours of the page's theme. */
  readonly theme: Theme;
  readonly labels: Label[] = [];

  constructor(
    camera: Camera,
    fixedFrame: string,
    theme: Theme,
    transforms: TransformBuffer,
    known: KnownPlaces,
  ) {
    super(fixedFrame, transforms, known);
    this.camera = camera;
    this.theme = theme;
  }

  /** Write text at a place of the fixed frame. */
  label(text: string, place: Vector, color?: string): void {
    const spot = this.camera.project(place);
    if (spot !== undefined) this.labels.push({ text, spot, color });
  }
}

/** Colours of the page. */
export interface Theme {
  readonly background: Color;
  readonly line: Color;
  readonly soft: Color;
  readonly ink: Color;
  readonly accent: Color;
}

/** The settings of a kind at first, with those that were saved. */
export function settingsOf(
  kind: LayerKind,
  saved: Readonly<Record<string, unknown>> = {},
): Settings {
  const settings: Settings = {};
  for (const { name, value, options } of kind.settings) {
    const found = saved[name];
    const fits =
      typeof found === typeof value && (options === undefined || options.includes(String(found)));
    settings[name] = fits ? (found as Value) : value;
  }
  return settings;
}
