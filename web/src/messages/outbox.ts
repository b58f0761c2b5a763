/** Messages on their way from the worker to the page: those of all streams go together. */
import type { Delivery } from "./feed";
import type { Batch } from "./worker_messages";

/** The time between two batches, in ms, unless all that waits may wait longer: about a picture. */
export const PICTURE = 16;
/** So many messages do not wait for others. */
const FULL = 250;

interface Numbered {
  readonly kind: string;
  readonly id: number;
  readonly delivery?: Delivery;
}

interface Waiting {
  readonly report: () => Numbered;
  readonly done: () => void;
}

/**
 * Each batch costs the page a task, whatever the number of its messages. The next one waits for a
 * picture's time, and until the page has taken the last: so they grow while the page is busy.
 */
export class Outbox {
  readonly #post: (report: object, transfer: Transferable[]) => void;
  #waiting: Waiting[] = [];
  /** How many messages wait. */
  #count = 0;
  /** The batches that the page has not taken yet. */
  readonly #sent: Waiting[][] = [];
  /** When the last batch was sent, and when the next one is due, by `performance.now()`. */
  #last = -Infinity;
  #due = Infinity;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(post: (report: object, transfer: Transferable[]) => void) {
    this.#post = post;
  }

  /**
   * Send a report about a message, at most `pause` ms after the last batch; resolves once it is taken.
   *
   * It is made when it is sent, so that it may be about messages that have come meanwhile.
   */
  put(report: () => Numbered, pause = PICTURE): Promise<void> {
    return new Promise((done) => {
      this.#waiting.push({ report, done });
      this.#count += 1;
      this.#hurry(this.#count < FULL ? this.#last + pause : -Infinity);
    });
  }

  /** A report that waits is about another message. */
  grow(): void {
    this.#count += 1;
    if (this.#count >= FULL) this.#hurry(-Infinity);
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

  #hurry(due: number): void {
    if (due >= this.#due) return;
    this.#due = due;
    this.#proceed();
  }

  #proceed(): void {
    clearTimeout(this.#timer);
    if (this.#waiting.length === 0 || this.#sent.length > 0) return;
    const delay = this.#due - performance.now();
    if (delay > 0) this.#timer = setTimeout(() => this.#send(), delay);
    else this.#send();
  }

  #send(): void {
    clearTimeout(this.#timer);
    const sent = this.#waiting;
    if (sent.length === 0) return;
    this.#waiting = [];
    this.#count = 0;
    this.#due = Infinity;
    this.#last = performance.now();
    this.#sent.push(sent);
    const reports = sent.map(({ report }) => report());
    const batch: Batch = { kind: "batch", reports };
    this.#post(batch, buffersOf(reports));
  }
}

/** The memory of the arrays in messages, which goes to the page with them. */
function buffersOf(reports: readonly Numbered[]): ArrayBuffer[] {
  const buffers = new Set<ArrayBuffer>();
  for (const { delivery } of reports) {
    for (const value of Object.values(delivery?.message ?? {}))
      if (ArrayBuffer.isView(value)) buffers.add(value.buffer as ArrayBuffer);
  }
  return [...buffers];
}
