/// <reference lib="webworker" />
// Receives all messages that the page shows, and prepares images and clouds, off the main thread.

import { Feed } from "./messages/feed";
import { openRelay } from "./messages/relay";
import type { Request as MessageRequest } from "./messages/worker_messages";
import { openPicture } from "./panels/image/remote_picture";
import type { Request as PictureRequest } from "./panels/image/worker_messages";
import type { Request as CloudRequest } from "./panels/scene/cloud_messages";
import { openCloud } from "./panels/scene/remote_cloud";

declare const self: DedicatedWorkerGlobalScope;

type Request = MessageRequest | PictureRequest | CloudRequest;
type Numbered = Extract<Request, { id: number }>;

/** What the page has opened, by its ids: each takes its further requests. */
const opened = new Map<number, (request: Numbered) => void>();
const feed = new Feed();

self.onmessage = ({ data }: MessageEvent<Request>): void => {
  switch (data.kind) {
    case "connect":
      feed.connect(data.url, data.token);
      return;
    case "disconnect":
      feed.close();
      return;
    case "messages":
      opened.set(data.id, openRelay(feed, data, post) as (request: Numbered) => void);
      return;
    case "picture":
      opened.set(data.id, openPicture(feed, data, post) as (request: Numbered) => void);
      return;
    case "cloud":
      opened.set(data.id, openCloud(feed, data, post) as (request: Numbered) => void);
      return;
  }
  opened.get(data.id)?.(data);
  if (data.kind === "close") opened.delete(data.id);
};

function post(report: object, transfer: Transferable[] = []): void {
  self.postMessage(report, transfer);
}
