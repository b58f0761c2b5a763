/** Passes the messages of a subscription on to the page; it runs in the worker. */
import type { Messages } from "./feed";
import type { Outbox } from "./outbox";
import type { Request } from "./worker_messages";

/** Subscribe for the page; return a function for its further requests. */
export function openRelay(
  messages: Messages,
  { kind: _, id, ...subscription }: Request & { kind: "messages" },
  outbox: Outbox,
): (request: Request) => void {
  const end = messages.subscribe({
    ...subscription,
    receive: (delivery) => outbox.put(() => ({ kind: "message", id, delivery })),
    fail: (why) => outbox.post({ kind: "fault", id, why }),
    ready: () => outbox.post({ kind: "ready", id }),
  });
  return ({ kind }) => {
    if (kind === "close") end();
  };
}
