/** The messages of one subscriber that wait until it has processed those before. */

/** A message that is read when it is its turn: those that are skipped cost nothing. */
export interface Unread<T> {
  read(): T;
}

interface Waiting<T> {
  readonly unread: Unread<T>;
  done(): void;
}

/** Messages that are given to a subscriber at once, at most. */
const MAX_BATCH = 200;

export class Inbox<T> {
  readonly #queue: number;
  readonly #throttle: number;
  readonly #receive: (batch: readonly T[]) => void | Promise<void>;
  readonly #fail: (why: string) => void;
  #waiting: Waiting<T>[] = [];
  #isBusy = false;
  #isClosed = false;
  /** When the next messages are due, by `performance.now()`. */
  #due = -Infinity;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /**
   * `queue` messages wait, and of more the newest; `throttle` is the least time between two calls of
   * `receive`, in ms. The next call comes once its promise is resolved.
   */
  constructor(
    queue: number,
    throttle: number,
    receive: (batch: readonly T[]) => void | Promise<void>,
    fail: (why: string) => void,
  ) {
    this.#queue = queue;
    this.#throttle = throttle;
    this.#receive = receive;
    this.#fail = fail;
  }

  /** Take a message; resolves once it is processed, or skipped. */
  offer(unread: Unread<T>, isThrottled: boolean): Promise<void> {
    return new Promise((done) => {
      if (this.#isClosed) {
        done();
        return;
      }
      if (this.#waiting.length >= this.#queue) this.#waiting.shift()?.done();
      this.#waiting.push({ unread, done });
      this.#proceed(isThrottled);
    });
  }

  /** Skip what waits, and all that is still offered. */
  close(): void {
    this.#isClosed = true;
    clearTimeout(this.#timer);
    for (const { done } of this.#waiting.splice(0)) done();
  }

  #proceed(isThrottled: boolean): void {
    if (this.#isBusy || this.#timer !== undefined || this.#waiting.length === 0) return;
    const delay = this.#due - performance.now();
    if (isThrottled && delay > 0) {
      this.#timer = setTimeout(() => {
        this.#timer = undefined;
        this.#proceed(false);
      }, delay);
      return;
    }
    this.#due = performance.now() + this.#throttle;
    void this.#process(this.#waiting.splice(0, MAX_BATCH), isThrottled);
  }

  async #process(taken: readonly Waiting<T>[], isThrottled: boolean): Promise<void> {
    this.#isBusy = true;
    try {
      const batch = taken.flatMap(({ unread }) => this.#read(unread));
      if (batch.length > 0) await this.#receive(batch);
    } catch (error) {
      this.#fail((error as Error).message);
    }
    this.#isBusy = false;
    for (const { done } of taken) done();
    this.#proceed(isThrottled);
  }

  /** Read a message; none if it is invalid, which must not hold back the others. */
  #read(unread: Unread<T>): T[] {
    try {
      return [unread.read()];
    } catch (error) {
      this.#fail((error as Error).message);
      return [];
    }
  }
}
