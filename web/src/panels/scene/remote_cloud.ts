/** Receives the point clouds of a topic, and prepares them for the graphics card, in the worker. */
import type { Delivery, Messages } from "../../messages/feed";
import { pack } from "./cloud";
import type { Report, Request } from "./cloud_messages";
import type { Header } from "./layer";

/** Subscribe for the page; return a function for its further requests. */
export function openCloud(
  messages: Messages,
  { id, topic, type, throttle, options }: Request & { kind: "cloud" },
  post: (report: Report, transfer?: Transferable[]) => void,
): (request: Request) => void {
  let { color, field, most } = options;
  let newest: Delivery | undefined;
  let done = (): void => undefined;
  const fail = (why: string): void => post({ kind: "fault", id, why });
  const send = ({ message, ...rest }: Delivery, isAgain: boolean): void => {
    const packed = pack(message, { color, field }, most);
    // Those of the message are kept for other colours.
    const data = packed.data.slice();
    const cloud = { header: message.header as Header, packed: { ...packed, data } };
    post({ kind: "cloud", id, message: cloud, isAgain, ...rest }, [data.buffer]);
  };
  const end = messages.subscribe({
    topic,
    type,
    throttle,
    queue: 1,
    receive: (delivery) => {
      newest = delivery;
      send(delivery, false);
      return new Promise((resolve) => {
        done = resolve;
      });
    },
    fail,
  });
  return (request) => {
    switch (request.kind) {
      case "taken":
        done();
        break;
      case "close":
        end();
        done();
        break;
      case "options":
        ({ color, field, most } = request.options);
        if (newest === undefined || !request.isAgain) break;
        try {
          send(newest, true);
        } catch (error) {
          fail((error as Error).message);
        }
    }
  };
}
