/** Where the messages of plots come from. */
import type { Message } from "../hub";
import { subscribe } from "../messages/data_client";
import type { DataSource } from "../source";

export interface PlotSource {
  /** The present, in seconds since 1970: the right end of a plot that moves. */
  now(): number;
  /** Call a listener when time jumps: what comes then is of another time; returns what ends this. */
  onJump(listener: () => void): () => void;
  /**
   * Receive every message of a topic, with its time; returns a function that ends this.
   *
   * `fail` is called with the reason why there are none; with an empty text if there are again.
   */
  subscribe(
    topic: string,
    receive: (message: Message, time: number) => void,
    fail: (why: string) => void,
  ): () => void;
}

/** How many messages wait while the page is busy: it needs each of them. */
const QUEUE = 10_000;
/** The time between two batches of messages, in ms: no plot is drawn more often. */
const PAUSE = 50;

/** The messages of a hub or a file, at the time that the page shows. */
export function plotSource(hub: DataSource): PlotSource {
  return {
    now: () => hub.clock.now() / 1000,
    onJump: (listener) => hub.clock.onJump(listener),
    subscribe: (topic, receive, fail) =>
      subscribe(
        hub,
        { topic, queue: QUEUE, pause: PAUSE },
        (message, { time }) => receive(message, time / 1000),
        fail,
      ),
  };
}
