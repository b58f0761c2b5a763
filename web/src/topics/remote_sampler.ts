/** Takes what is plotted out of each message of a topic, in the worker: the page gets numbers alone. */
import type { Delivery, Messages } from "../messages/feed";
import type { Outbox } from "../messages/outbox";
import { secondsOf } from "../messages/values";
import { Stamps } from "../simulated_time";
import { own } from "../types";
import { type FieldReader, readerOf } from "./field_readers";
import type { Report, Request } from "./sample_messages";

/** How many messages wait while the worker is busy: each of them counts. */
const QUEUE = 10_000;
/** The time between two batches, in ms: no plot is drawn more often. */
const PAUSE = 50;
/** A header's time is used if it differs from the clock by no more than this, in seconds. */
const MAX_SKEW = 5;

/** Subscribe for the page; return a function for its further requests. */
export function openSamples(
  messages: Messages,
  request: Request & { kind: "samples" },
  outbox: Outbox,
): (request: Request) => void {
  const { id, topic } = request;
  const readers = new Map<number, FieldReader>();
  for (const [key, wanted] of request.wanted) readers.set(key, readerOf(wanted));
  let stamps = new Stamps();
  let newest: { readonly message: unknown; readonly time: number } | undefined;
  let missing = "";
  /** Whether a report waits to be sent; the promise resolves once the page has it. */
  let isWaiting = false;
  let taken = Promise.resolve();

  const read = (reader: FieldReader, message: unknown, time: number): void => {
    if (reader.read(message, time)) missing = reader.path;
  };
  const report = (): Report => {
    isWaiting = false;
    const pieces = [...readers].flatMap(([key, reader]) => {
      const piece = reader.take();
      return piece === undefined ? [] : [[key, piece] as const];
    });
    return { kind: "samples", id, pieces, missing };
  };
  const send = (): Promise<void> => {
    if (isWaiting) {
      outbox.grow();
      return taken;
    }
    isWaiting = true;
    taken = outbox.put(report, PAUSE);
    return taken;
  };
  const receive = ({ message, time: arrived }: Delivery): Promise<void> => {
    missing = "";
    const stamp = secondsOf(own(own(message, "header"), "stamp"));
    const time = timeOf(stamp, arrived / 1000);
    // A curve of two runs would be none of both.
    if (stamps.hasGoneBack(stamp)) for (const reader of readers.values()) reader.clear();
    newest = { message, time };
    for (const reader of readers.values()) read(reader, message, time);
    return send();
  };
  const end = messages.subscribe({
    topic,
    throttle: 0,
    queue: QUEUE,
    span: 1000 * request.span,
    receive,
    fail: (why) => outbox.post({ kind: "fault", id, why }),
    jump: () => {
      stamps = new Stamps();
      newest = undefined;
      for (const reader of readers.values()) reader.reset();
    },
  });
  return (next) => {
    switch (next.kind) {
      case "add": {
        const reader = readerOf(next.wanted);
        readers.set(next.key, reader);
        // A slow topic has a value at once.
        if (newest === undefined) break;
        read(reader, newest.message, newest.time);
        void send();
        break;
      }
      case "remove":
        readers.delete(next.key);
        break;
      case "close":
        end();
    }
  };
}

/** The time of a message in seconds: that of its header if it is plausible, else that of its arrival. */
export function timeOf(stamp: number | undefined, arrived: number): number {
  return stamp !== undefined && Math.abs(stamp - arrived) <= MAX_SKEW ? stamp : arrived;
}
