/** Messages on their way from the worker to the page: those of all streams go together. */
import type { Delivery } from "./feed";
import type { Batch, Report } from "./worker_messages";

/** The time between two batches, in ms, unless all subscribers accept more: about a picture. */
export const PICTURE = 16;
/** So many messages do not wait for others. */
const FULL = 250;

/** A message that waits. */
interface Waiting {
  readonly report: Report & { kind: "message" };
  readonly done: () => void;
}

/**
 * Each batch costs the page a task, whatever the number of its messages. The next one waits for a
 * picture's time, and until the page has taken the last: so they grow while the page is busy.
 */
export class Outbox {
  readonly #post: (report: object, transfer: Transferable[]) => void;
  #waiting: Waiting[] = [];
  /** The messages of the batches that the page has not taken yet. */
  readonly #sent: Waiting[][] = [];
  /** When the last batch was sent, and when the next one is due, by `performance.now()`. */
  #last = -Infinity;
  #due = Infinity;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(post: (report: object, transfer: Transferable[]) => void) {
    this.#post = post;
  }

  /** Send a message to a stream, at most `pause` ms after the last batch; resolves once it is taken. */
  put(id: number, delivery: Delivery, pause = PICTURE): Promise<void> {
    return new Promise((done) => {
      this.#waiting.push({ report: { kind: "message", id, delivery }, done });
      const due = this.#waiting.length < FULL ? this.#last + pause : -Infinity;
      if (due >= this.#due) return;
      this.#due = due;
      this.#proceed();
    });
  }

  /** Send something else, after the messages so far. */
  readonly post = (report: object, transfer: Transferable[] = []): void => {
    this.#send();
    this.#post(report, transfer);
  };

  /** The page has taken a batch. */
  taken(): void {
    for (const { done } of this.#sent.shift() ?? []) done();
    this.#proceed();
  }

  #proceed(): void {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    if (this.#waiting.length === 0 || this.#sent.length > 0) return;
    const delay = this.#due - performance.now();
    if (delay > 0) this.#timer = setTimeout(() => this.#send(), delay);
    else this.#send();
  }

  #send(): void {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    const sent = this.#waiting;
    if (sent.length === 0) return;
    this.#waiting = [];
    this.#due = Infinity;
    this.#last = performance.now();
    this.#sent.push(sent);
    const batch: Batch = { kind: "batch", messages: sent.map(({ report }) => report) };
    this.#post(batch, buffersOf(sent));
  }
}

/** The memory of the arrays in messages, which goes to the page with them. */
function buffersOf(sent: readonly Waiting[]): ArrayBuffer[] {
  const buffers = new Set<ArrayBuffer>();
  for (const { report } of sent) {
    const { message } = report.delivery;
    for (const name in message) {
      const value = message[name];
      if (ArrayBuffer.isView(value)) buffers.add(value.buffer as ArrayBuffer);
    }
  }
  return [...buffers];
}
