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

/** Pass messages on to the page, one at a time: meanwhile only the newest one waits. */
function relay({ id, topic, typedefs, throttle }: Request & { kind: "messages" }): Relay {
  let isBusy = false;
  let waiting: Fields | undefined;
  const send = (message: Fields): void => {
    isBusy = true;
    waiting = undefined;
    const arrays = Object.values(message).filter((each) => ArrayBuffer.isView(each));
    const buffers = new Set(arrays.map(({ buffer }) => buffer as ArrayBuffer));
    self.postMessage({ kind: "message", id, message } satisfies Report, [...buffers]);
  };
  const receive = (message: Fields): void => {
    if (isBusy) waiting = message;
    else send(message);
  };
  const fail = (why: string): void => report({ kind: "fault", id, why });
  const stop = feed.subscribe({ topic, typedefs, throttle, receive, fail });
  const taken = (): void => {
    isBusy = false;
    if (waiting !== undefined) send(waiting);
  };
  return { taken, stop };
}

function subscribe(subscriber: Omit<Subscriber, "throttle">, throttle: number): () => void {
  return feed.subscribe({ ...subscriber, throttle });
}

function report(message: Report): void {
  self.postMessage(message);
}
