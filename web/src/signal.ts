/** A value that tells those who watch it of each change. */
export interface Signal<T> {
  readonly value: T;
  /** Calls the listener at once and at each change; gives what ends that. */
  watch(listener: (value: T) => void): () => void;
}

/** A signal's owner: the one who sets it. */
export class Source<T> implements Signal<T> {
  #value: T;
  readonly #listeners = new Set<(value: T) => void>();

  constructor(value: T) {
    this.#value = value;
  }

  get value(): T {
    return this.#value;
  }

  set(value: T): void {
    if (Object.is(value, this.#value)) return;
    this.#value = value;
    for (const listener of [...this.#listeners]) {
      // A listener may have left while another was told.
      if (this.#listeners.has(listener)) listener(value);
    }
  }

  watch(listener: (value: T) => void): () => void {
    // Wrapped, so that the same function may watch twice and leave twice.
    const own = (value: T): void => listener(value);
    this.#listeners.add(own);
    listener(this.#value);
    return () => this.#listeners.delete(own);
  }
}
