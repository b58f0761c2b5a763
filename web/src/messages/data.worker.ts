/// <reference lib="webworker" />
// Receives the messages that are large or many, and draws images, off the main thread.

import { Picture } from "../panels/image/picture";
import { Feed, type Subscriber } from "./feed";
import type { Report, Request } from "./worker_messages";

declare const self: DedicatedWorkerGlobalScope;

/** A picture on the page, and its subscription. */
interface Panel {
  readonly picture: Picture;
  readonly subscriber: Omit<Subscriber, "throttle">;
  stop(): void;
}

const panels = new Map<number, Panel>();
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

function subscribe(subscriber: Omit<Subscriber, "throttle">, throttle: number): () => void {
  return feed.subscribe({ ...subscriber, throttle });
}

function report(message: Report): void {
  self.postMessage(message);
}
