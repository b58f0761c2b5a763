/** One layer of the scene: its subscription, and its state in words. */
import { ago } from "../../format";
import { subscribe } from "../../messages/data_client";
import type { Fields } from "../../messages/reader";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import {
  type Header,
  type Layer,
  type LayerKind,
  NO_PROBLEMS,
  type Places,
  type Settings,
  settingsOf,
  type View,
} from "./layer";
import type { TransformBuffer } from "./tf_buffer";

/** A stream without a message for this time is worth a word, in ms. */
const SILENT = 3000;
/** The age of an event is worth a word from this time on, in ms. */
const AGED = 5000;
/** Updates that wait while others are processed. */
const MAX_UPDATES = 100;

export type Level = "off" | "good" | "warn" | "bad";

export interface State {
  readonly level: Level;
  readonly text: string;
}

/** Why a layer is wrong, in words; empty texts where it is not. */
interface Faults {
  /** Why there are no messages. */
  readonly feed: string;
  /** Why the last message could not be taken. */
  readonly message: string;
  /** Why the settings cannot be used. */
  readonly settings: string;
  /** Why there is no layer. */
  readonly layer: string;
  /** Why the last picture does not have it. */
  readonly drawing: string;
}

const NO_FAULTS: Faults = { feed: "", message: "", settings: "", layer: "", drawing: "" };

/** What entries share. */
export interface Surroundings {
  readonly hub: DataSource;
  readonly model: Model;
  readonly transforms: TransformBuffer;
  redraw(): void;
}

export class Entry {
  readonly kind: LayerKind;
  readonly topic: string;
  readonly type: string;
  readonly settings: Settings;
  /** Whether it is drawn, which needs a subscription. */
  isOn = false;
  layer: Layer | undefined;
  readonly #scene: Surroundings;
  #stop: (() => void) | undefined;
  #faults = NO_FAULTS;
  /** When the newest message arrived, in ms since 1970; 0 before the first. */
  #arrived = 0;
  /** Its stamp, and when a message with that first arrived. */
  #stamp = "";
  #since = 0;
  /** Whether what the layer has is of another time. */
  #isCleared = false;
  /** The frame of the first message with one. */
  frame = "";

  constructor(
    scene: Surroundings,
    kind: LayerKind,
    topic: string,
    type: string,
    saved?: Readonly<Record<string, unknown>>,
  ) {
    this.#scene = scene;
    this.kind = kind;
    this.topic = topic;
    this.type = type;
    this.settings = settingsOf(kind, saved);
  }

  /** Subscribe, and draw. */
  start(): void {
    this.isOn = true;
    if (this.#stop !== undefined) return;
    let isStopped = false;
    let ends: (() => void)[] = [];
    this.#stop = () => {
      isStopped = true;
      for (const end of ends) end();
      this.layer?.pause?.();
    };
    this.#make().then(
      (layer) => {
        if (isStopped) {
          if (layer !== this.layer) layer.close();
          return;
        }
        this.layer = layer;
        layer.resume?.();
        if (!this.kind.isOwn) ends = this.#subscriptions();
        this.#scene.redraw();
      },
      (error: unknown) => this.#fail("layer", (error as Error).message),
    );
  }

  /** The layer, for which code may have to be loaded. */
  async #make(): Promise<Layer> {
    const { hub, model, transforms, redraw } = this.#scene;
    const { topic, type, settings } = this;
    const context = { hub, model, topic, type, settings, transforms, redraw };
    return this.layer ?? (await this.kind.make(context));
  }

  #subscriptions(): (() => void)[] {
    const { topic, type, kind } = this;
    const receive = (message: Fields): void => this.#receive(message);
    const ends = [this.#subscribe(topic, type, kind.queue ?? 1, receive)];
    const updates = kind.updates?.(topic);
    if (updates !== undefined) ends.push(this.#subscribeUpdates(updates));
    return ends;
  }

  #subscribe(
    topic: string,
    type: string,
    queue: number,
    receive: (message: Fields) => void,
  ): () => void {
    const throttle = queue > 1 ? 0 : this.kind.throttle;
    const wanted = { topic, type, throttle, queue };
    const fail = (why: string): void => this.#fail("feed", why);
    // Updates are of another topic.
    const own = topic === this.topic ? this.layer?.subscribe : undefined;
    return (
      own?.call(this.layer, wanted, receive, fail) ??
      subscribe(this.#scene.hub, wanted, receive, fail)
    );
  }

  /** Subscribe to updates once a node publishes them: else the page would create the topic. */
  #subscribeUpdates({ topic, type }: { topic: string; type: string }): () => void {
    let end: (() => void) | undefined;
    const stop = this.#scene.model.graph.watch((graph) => {
      const exists = graph?.topics.some((each) => each.name === topic && each.type === type);
      if (!exists || end !== undefined) return;
      end = this.#subscribe(topic, type, MAX_UPDATES, (message) =>
        this.#take(() => this.layer?.receiveUpdate?.(message, this.#scene.hub.clock.now())),
      );
    });
    return () => {
      stop();
      end?.();
    };
  }

  /** End the subscription; what has been drawn stays. */
  pause(): void {
    this.#stop?.();
    this.#stop = undefined;
  }

  /** End, and forget all messages. */
  stop(): void {
    this.isOn = false;
    this.pause();
    this.layer?.close();
    this.layer = undefined;
    this.#faults = NO_FAULTS;
    this.#arrived = 0;
    this.#stamp = "";
  }

  /** Time has jumped: show nothing until there is a message of then. */
  clear(): void {
    this.#arrived = 0;
    this.#stamp = "";
    this.#isCleared = !this.kind.isOwn;
    this.layer?.clear?.();
  }

  #receive(message: Fields): void {
    this.#isCleared = false;
    const now = this.#scene.hub.clock.now();
    const header = message.header as Header | undefined;
    const { secs, nsecs } = header?.stamp ?? { secs: 0, nsecs: 0 };
    const stamp = secs === 0 && nsecs === 0 ? "" : `${secs} ${nsecs}`;
    // A latched message comes again when the scene is shown again, and is no younger.
    if (stamp === "" || stamp !== this.#stamp) this.#since = now;
    this.#stamp = stamp;
    this.#arrived = now;
    this.#fail("feed", "");
    this.frame ||= header?.frame_id ?? "";
    this.#take(() => this.layer?.receive?.(message, now));
  }

  #take(receive: () => void): void {
    // A message that could be taken has been made ready for the settings, too.
    if (this.#attempt("message", receive)) this.#fail("settings", "");
    this.#scene.redraw();
  }

  /** Do something, and keep why it failed; return whether it did not. */
  #attempt(what: keyof Faults, run: () => void): boolean {
    try {
      run();
      this.#fail(what, "");
      return true;
    } catch (error) {
      const { message } = error as Error;
      if (this.#faults[what] !== message) console.debug(error);
      this.#fail(what, message);
      return false;
    }
  }

  #fail(what: keyof Faults, why: string): void {
    if (this.#faults[what] !== why) this.#faults = { ...this.#faults, [what]: why };
  }

  /** Settings have changed. */
  update(): void {
    this.#attempt("settings", () => this.layer?.update?.());
    this.#scene.redraw();
  }

  draw(view: View): void {
    if (this.#isCleared) return;
    // One layer must not end the picture of all others.
    this.#attempt("drawing", () => this.layer?.draw(view));
  }

  /**
   * The state at a time, in ms since 1970, whether or not anything is drawn.
   *
   * `isPublished`: whether a node publishes the topic; `places`: where frames are now.
   */
  state(now: number, isPublished: boolean, places: Places): State {
    if (!this.isOn) return { level: "off", text: "" };
    const { feed, message, settings, layer, drawing } = this.#faults;
    const problems = this.layer?.problems(places) ?? NO_PROBLEMS;
    const error = feed || message || settings || layer || drawing || problems.error;
    if (error !== "") return { level: "bad", text: error };
    const { isOwn = false, isStream = false } = this.kind;
    if (!isOwn && this.#arrived === 0) {
      const text = isPublished ? "waiting for the first message" : "no node publishes it";
      return { level: "warn", text };
    }
    const silence = now - this.#arrived;
    if (problems.warning !== "") return { level: "warn", text: problems.warning };
    const facts = this.layer?.facts(places) ?? "";
    if (isStream && silence > SILENT) {
      const silent = `no message for ${Math.floor(silence / 1000)} s`;
      return { level: "warn", text: facts === "" ? silent : `${facts}, ${silent}` };
    }
    const age = now - this.#since;
    const aged = this.kind.isEvent === true && age > AGED ? `, ${ago(age / 1000)}` : "";
    return { level: "good", text: `${facts}${aged}` };
  }
}
