/** Passes the messages of a subscription on to the page, in batches; it runs in the worker. */
import type { Delivery, Feed } from "./feed";
import type { Report, Request } from "./worker_messages";

/** Subscribe for the page; return a function for its further requests. */
export function openRelay(
  feed: Feed,
  { kind: _, id, ...subscription }: Request & { kind: "messages" },
  post: (report: Report, transfer?: Transferable[]) => void,
): (request: Request) => void {
  let done = (): void => undefined;
  const end = feed.subscribe({
    ...subscription,
    receive: (batch) =>
      new Promise((resolve) => {
        done = resolve;
        post({ kind: "messages", id, batch }, buffersOf(batch));
      }),
    fail: (why) => post({ kind: "fault", id, why }),
    ready: () => post({ kind: "ready", id }),
  });
  return ({ kind }) => {
    if (kind === "close") end();
    // The hub waits for nothing that nobody takes.
    done();
  };
}

/** The memory of the arrays in messages, which goes to the page with them. */
function buffersOf(batch: readonly Delivery[]): ArrayBuffer[] {
  const arrays = batch.flatMap(({ message }) =>
    Object.values(message).filter((each) => ArrayBuffer.isView(each)),
  );
  return [...new Set(arrays.map(({ buffer }) => buffer as ArrayBuffer))];
}
