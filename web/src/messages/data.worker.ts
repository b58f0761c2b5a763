/// <reference lib="webworker" />
// Receives the messages that are large or many, and draws images, off the main thread.

import { Picture } from "../panels/image/picture";
import { Feed, type Subscriber } from "./feed";
import type { Fields } from "./reader";
import type { Report, Request } from "./worker_messages";

declare const self: DedicatedWorkerGlobalScope;

/** A picture on the page, and its subscription. */
interface Panel {
  readonly picture: Picture;
  readonly subscriber: Omit<Subscriber, "throttle">;
  stop(): void;
}

/** A subscription of the page. */
interface Relay {
  taken(): void;
  stop(): void;
}

const panels = new Map<number, Panel>();
const relays = new Map<number, Relay>();
const feed = new Feed();

self.onmessage = ({ data }: MessageEvent<Request>): void => {
  if (data.kind === "connect") {
    feed.connect(data.url, data.token);
    return;
  }
  if (data.kind === "disconnect") {
    feed.close();
    return;
  }
  if (data.kind === "picture") {
    panels.set(data.id, open(data));
    return;
  }
  if (data.kind === "messages") {
    relays.set(data.id, relay(data));
    return;
  }
  const known = relays.get(data.id);
  if (known !== undefined) {
    if (data.kind === "taken") known.taken();
    if (data.kind === "close") {
      known.stop();
      relays.delete(data.id);
    }
    return;
  }
  const panel = panels.get(data.id);
  if (panel === undefined) return;
  const { picture, subscriber } = panel;
  switch (data.kind) {
    case "throttle":
      panel.stop();
      panel.stop = data.throttle === null ? () => undefined : subscribe(subscriber, data.throttle);
      break;
    case "options":
      picture.options = data.options;
      break;
    case "value":
      report({ ...data, text: picture.valueAt(data.x, data.y) });
      break;
    case "file":
      void picture.canvas
        .convertToBlob({ type: "image/png" })
        .then((file) => report({ kind: "file", id: data.id, file }));
      break;
    case "close":
      panel.stop();
      panels.delete(data.id);
      break;
  }
};

function open({ id, canvas, topic, typedefs, throttle }: Request & { kind: "picture" }): Panel {
  const fail = (why: string): void => report({ kind: "fault", id, why });
  const picture = new Picture(canvas, (state) => report({ kind: "state", id, state }), fail);
  const receive = picture.receive.bind(picture);
  const subscriber = { topic, typedefs, receive, fail };
  return { picture, subscriber, stop: subscribe(subscriber, throttle) };
}

/** Pass messages on to the page, one at a time: meanwhile the newest ones wait. */
function relay({ id, queue, ...subscription }: Request & { kind: "messages" }): Relay {
  let done: (() => void) | undefined;
  const waiting: { message: Fields; resolve: () => void }[] = [];
  const next = (): void => {
    const first = waiting.shift();
    done = first?.resolve;
    if (first !== undefined) send(id, first.message);
  };
  const receive = (message: Fields): Promise<void> =>
    new Promise((resolve) => {
      // A skipped one is processed, too.
      if (waiting.length >= queue) waiting.shift()?.resolve();
      waiting.push({ message, resolve });
      if (done === undefined) next();
    });
  const fail = (why: string): void => report({ kind: "fault", id, why });
  const end = feed.subscribe({ ...subscription, queue, receive, fail });
  const stop = (): void => {
    end();
    // The hub waits for nothing that nobody takes.
    done?.();
    for (const { resolve } of waiting) resolve();
  };
  const taken = (): void => {
    done?.();
    next();
  };
  return { taken, stop };
}

/** Send a message to the page, and with it the memory of its arrays. */
function send(id: number, message: Fields): void {
  const arrays = Object.values(message).filter((each) => ArrayBuffer.isView(each));
  const buffers = new Set(arrays.map(({ buffer }) => buffer as ArrayBuffer));
  self.postMessage({ kind: "message", id, message } satisfies Report, [...buffers]);
}

function subscribe(subscriber: Omit<Subscriber, "throttle">, throttle: number): () => void {
  return feed.subscribe({ ...subscriber, throttle });
}

function report(message: Report): void {
  self.postMessage(message);
}
