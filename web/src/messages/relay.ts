/** Passes the messages of a subscription on to the page; it runs in the worker. */
import type { Delivery, Messages } from "./feed";
import type { Report, Request } from "./worker_messages";

/** Subscribe for the page; return a function for its further requests. */
export function openRelay(
  messages: Messages,
  { kind: _, id, ...subscription }: Request & { kind: "messages" },
  post: (report: Report, transfer?: Transferable[]) => void,
): (request: Request) => void {
  /** Those of the messages that the page has not taken yet. */
  let done: (() => void)[] = [];
  const end = messages.subscribe({
    ...subscription,
    receive: (delivery) =>
      new Promise((resolve) => {
        done.push(resolve);
        post({ kind: "message", id, delivery }, buffersOf(delivery));
      }),
    fail: (why) => post({ kind: "fault", id, why }),
    ready: () => post({ kind: "ready", id }),
  });
  return ({ kind }) => {
    if (kind === "taken") done.shift()?.();
    if (kind !== "close") return;
    end();
    // The hub waits for nothing that nobody takes.
    for (const each of done) each();
    done = [];
  };
}

/** The memory of the arrays in a message, which goes to the page with it. */
function buffersOf({ message }: Delivery): ArrayBuffer[] {
  const arrays = Object.values(message).filter((each) => ArrayBuffer.isView(each));
  return [...new Set(arrays.map(({ buffer }) => buffer as ArrayBuffer))];
}
