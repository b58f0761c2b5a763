/** A picture on the page, whose images are received and drawn here, in the worker. */
import type { Messages } from "../../messages/feed";
import { Picture } from "./picture";
import type { Report, Request } from "./worker_messages";

/** Draw the images of a topic; return a function for further requests. */
export function openPicture(
  messages: Messages,
  { id, canvas, topic, type, throttle }: Request & { kind: "picture" },
  post: (report: Report) => void,
): (request: Request) => void {
  const fail = (why: string): void => post({ kind: "fault", id, why });
  const picture = new Picture(canvas, (state) => post({ kind: "state", id, state }), fail);
  const subscribe = (least: number): (() => void) =>
    messages.subscribe({
      topic,
      type,
      throttle: least,
      queue: 1,
      receive: ({ message, size }) => picture.receive(message, size),
      fail,
    });
  let stop = subscribe(throttle);
  return (request) => {
    switch (request.kind) {
      case "throttle":
        stop();
        stop = request.throttle === null ? () => undefined : subscribe(request.throttle);
        break;
      case "options":
        picture.options = request.options;
        break;
      case "value":
        post({ ...request, text: picture.valueAt(request.x, request.y) });
        break;
      case "file":
        void picture.canvas
          .convertToBlob({ type: "image/png" })
          .then((file) => post({ kind: "file", id, file }));
        break;
      case "close":
        stop();
        break;
    }
  };
}
