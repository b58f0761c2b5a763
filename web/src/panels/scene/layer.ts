/** What a layer of the scene is: it takes the messages of a topic, and draws them. */
import type { Hub } from "../../hub";
import type { Fields } from "../../messages/reader";
import type { Graph, Model } from "../../model";
import type { Transform, Vector } from "../../transforms";
import type { Camera, Spot } from "./camera";
import type { Color } from "./colors";
import { FrameError, frameName, type TransformBuffer } from "./tf_buffer";

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
  /** What it draws: `Laser scan`. */
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
  readonly hub: Hub;
  readonly model: Model;
  readonly topic: string;
  readonly type: string;
  /** The current settings; the scene changes them, and then calls `update`. */
  readonly settings: Settings;
  readonly transforms: TransformBuffer;
  /** The picture has changed: draw it soon. */
  redraw(): void;
  /** Show why the layer is wrong, until it is called with an empty text. */
  fail(why: string): void;
}

export interface Layer {
  /** Take a message; throw an `Error` that says what is wrong with it. `now` is in ms since 1970. */
  receive?(message: Fields, now: number): void;
  /** Take a message of the kind's `updates`, none of which is skipped. */
  receiveUpdate?(message: Fields, now: number): void;
  /** Draw what there is. */
  draw(view: View): void;
  /** What it shows, in words: `180 points, nearest 0.42 m at 12°`. */
  facts(): string;
  /** The settings have changed. */
  update?(): void;
  /** What is under the pointer. */
  pick?(view: View, pointer: Pointer): Hit | undefined;
  /** Points of the fixed frame that a picture of everything has in it. */
  extent?(view: View): Vector[];
  /** Settings that depend on messages, such as namespaces, and their elements. */
  controls?(): HTMLElement | undefined;
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

/** What a layer needs to draw one picture: the camera and the places of frames. */
export class View {
  readonly camera: Camera;
  readonly fixedFrame: string;
  /** Colours of the page's theme. */
  readonly theme: Theme;
  readonly labels: Label[] = [];
  /** What is wrong with the layer that is drawn now: an error, or a warning. */
  error = "";
  warning = "";
  readonly #transforms: TransformBuffer;
  readonly #exact: WeakMap<object, { target: string; transform: Transform }>;

  constructor(
    camera: Camera,
    fixedFrame: string,
    theme: Theme,
    transforms: TransformBuffer,
    exact: WeakMap<object, { target: string; transform: Transform }>,
  ) {
    this.camera = camera;
    this.fixedFrame = fixedFrame;
    this.theme = theme;
    this.#transforms = transforms;
    this.#exact = exact;
  }

  /**
   * Where the frame of a message is in the fixed frame, at the time of its stamp.
   *
   * `undefined` if that is unknown: the layer's row says why. If tf does not have that time, it is
   * the nearest one. Pass the message's own header, since what has been found for it is kept.
   */
  place(header: Header): Transform | undefined {
    const known = this.#exact.get(header);
    if (known?.target === this.fixedFrame) return known.transform;
    const { secs, nsecs } = header.stamp;
    const found = this.#lookup(header.frame_id, secs * 1000 + nsecs / 1e6);
    if (found === undefined) return undefined;
    if (found.apart === 0) {
      this.#exact.set(header, { target: this.fixedFrame, transform: found.transform });
    } else if (found.apart > APART) {
      this.warning = `tf is ${(found.apart / 1000).toFixed(1)} s from the message's time`;
    }
    return found.transform;
  }

  /** Where a frame is now in the fixed frame; `undefined` if that is unknown. */
  placeNow(frame: string): Transform | undefined {
    return this.#lookup(frame, 0)?.transform;
  }

  /** As `placeNow`, but it is not wrong if that is unknown. */
  placeIfKnown(frame: string): Transform | undefined {
    const { error } = this;
    const found = this.placeNow(frame);
    this.error = error;
    return found;
  }

  #lookup(frame: string, stamp: number): { transform: Transform; apart: number } | undefined {
    const source = frameName(frame);
    if (source === "") {
      this.warning = `no frame_id: shown in ${this.fixedFrame}`;
    }
    try {
      return this.#transforms.lookup(this.fixedFrame, source || this.fixedFrame, stamp);
    } catch (error) {
      if (!(error instanceof FrameError)) throw error;
      this.error = error.message;
      return undefined;
    }
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
