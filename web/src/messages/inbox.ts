/** The messages of one subscriber that wait until it has processed those before. */

/** A message that is read when it is its turn: those that are skipped cost nothing. */
type Read<T> = () => T;

interface Waiting<T> {
  readonly read: Read<T>;
  done(): void;
}

export class Inbox<T> {
  readonly #queue: number;
  readonly #throttle: number;
  readonly #receive: (message: T) => void | Promise<void>;
  readonly #fail: (why: string) => void;
  #waiting: Waiting<T>[] = [];
  /** How many messages are being processed. */
  #busy = 0;
  #isClosed = false;
  /** When the next message is due, by `performance.now()`. */
  #due = -Infinity;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /**
   * `queue` messages are processed at a time, so that the order of several topics is kept, and as
   * many wait; of more, the oldest are skipped. `throttle` is the least time between two of them.
   */
  constructor(
    queue: number,
    throttle: number,
    receive: (message: T) => void | Promise<void>,
    fail: (why: string) => void,
  ) {
    this.#queue = queue;
    this.#throttle = throttle;
    this.#receive = receive;
    this.#fail = fail;
  }

  /** Take a message; `done` is called once it is processed, or skipped. */
  offer(read: Read<T>, isThrottled: boolean, done: () => void): void {
    if (this.#isClosed) {
      done();
      return;
    }
    if (this.#waiting.length >= this.#queue) this.#waiting.shift()?.done();
    this.#waiting.push({ read, done });
    this.#proceed(isThrottled);
  }

  /** Skip what waits, and all that is still offered. */
  close(): void {
    this.#isClosed = true;
    clearTimeout(this.#timer);
    for (const { done } of this.#waiting.splice(0)) done();
  }

  #proceed(isThrottled: boolean): void {
    while (this.#busy < this.#queue && this.#timer === undefined) {
      const next = this.#waiting[0];
      if (next === undefined) return;
      const delay = isThrottled ? this.#due - performance.now() : 0;
      if (delay > 0) {
        this.#timer = setTimeout(() => {
          this.#timer = undefined;
          this.#proceed(false);
        }, delay);
        return;
      }
      if (this.#throttle > 0) this.#due = performance.now() + this.#throttle;
      this.#waiting.shift();
      this.#process(next, isThrottled);
    }
  }

  #process({ read, done }: Waiting<T>, isThrottled: boolean): void {
    let processed: Promise<void> | undefined;
    this.#busy += 1;
    try {
      processed = this.#receive(read()) ?? undefined;
    } catch (error) {
      this.#fail((error as Error).message);
    }
    if (processed === undefined) {
      this.#busy -= 1;
      done();
      return;
    }
    const finish = (): void => {
      this.#busy -= 1;
      done();
      this.#proceed(isThrottled);
    };
    processed.then(finish, (error: unknown) => {
      this.#fail((error as Error).message);
      finish();
    });
  }
}
