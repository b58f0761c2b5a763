/// <reference lib="webworker" />
// Receives all messages that the page shows, and prepares images and clouds, off the main thread.
// Most visits have neither: their code is loaded when they are first opened.

import { Feed, type Messages } from "./messages/feed";
import { Outbox } from "./messages/outbox";
import type { Player } from "./messages/player";
import type { FileRequest, Origin } from "./messages/recording_messages";
import { openRelay } from "./messages/relay";
import type { Request as MessageRequest } from "./messages/worker_messages";
import type { Request as PictureRequest } from "./panels/image/worker_messages";
import type { Request as CloudRequest } from "./panels/scene/cloud_messages";
import type { Request as SampleRequest } from "./topics/sample_messages";

declare const self: DedicatedWorkerGlobalScope;

type Request = MessageRequest | PictureRequest | CloudRequest | SampleRequest | FileRequest;
type Numbered = Extract<Request, { id: number }>;

type Handle = (request: Numbered) => void;

/** What the page has opened, by its ids: each takes its further requests, once its code is loaded. */
const opened = new Map<number, Promise<Handle>>();
const feed = new Feed();
const outbox = new Outbox((report, transfer) => self.postMessage(report, transfer));
const { post } = outbox;
/** What the page shows: what the hub sends, or a recording. */
let messages: Promise<Messages> = Promise.resolve(feed);
/** Shows what was kept, once that is asked for. */
let player: Promise<Player> | undefined;

self.onmessage = ({ data }: MessageEvent<Request>): void => {
  if (data.kind === "connect") feed.connect(data.url, data.token);
  else if (data.kind === "disconnect") feed.close();
  else if (data.kind === "taken batch") outbox.taken();
  else if (data.kind === "keep") keep();
  else if (data.kind === "play file") openFile(data.origin);
  else if (data.kind === "playback")
    player?.then((each) => each.control(data.command), console.debug);
  else receive(data);
};

function keep(): void {
  player ??= import("./messages/timeline").then((timeline) => timeline.keep(feed, post));
}

function openFile(origin: Origin): void {
  const opening = import("./recordings/open").then(({ openRecording }) =>
    openRecording(origin, post),
  );
  messages = opening;
  player = opening.then((recorded) => recorded.player);
  player.catch(console.debug);
}

/** What panels subscribe to, once messages are kept, if they are to be: none is missed. */
async function source(): Promise<Messages> {
  await player?.catch(console.debug);
  return messages;
}

function receive(request: Numbered): void {
  const { id } = request;
  const handle = open(request);
  if (handle !== undefined) {
    opened.set(id, handle as Promise<Handle>);
    handle.catch((error: unknown) => post({ kind: "fault", id, why: (error as Error).message }));
    return;
  }
  // If the code was not loaded, the page knows.
  opened.get(id)?.then((next) => next(request), console.debug);
  if (request.kind === "close") opened.delete(id);
}

/** Open what a request asks for; `undefined` if it is about something that is open. */
function open(request: Numbered): Promise<(request: never) => void> | undefined {
  switch (request.kind) {
    case "messages":
      return source().then((each) => openRelay(each, request, outbox));
    case "samples":
      return Promise.all([import("./topics/remote_sampler"), source()]).then(
        ([{ openSamples }, each]) => openSamples(each, request, outbox),
      );
    case "picture":
      return Promise.all([import("./panels/image/remote_picture"), source()]).then(
        ([{ openPicture }, each]) => openPicture(each, request, post),
      );
    case "cloud":
      return Promise.all([import("./panels/scene/remote_cloud"), source()]).then(
        ([{ openCloud }, each]) => openCloud(each, request, post),
      );
    default:
      return undefined;
  }
}
