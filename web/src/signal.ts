/** An observable value. */
export interface Signal<T> {
  readonly value: T;
  /** Call the listener now and at each change; returns a function that stops this. */
  watch(listener: (value: T) => void): () => void;
}

/** A signal that can be set. */
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
      // Another listener may have removed it just now.
      if (this.#listeners.has(listener)) listener(value);
    }
  }

  watch(listener: (value: T) => void): () => void {
    // Wrapped, so that the same function can watch twice and stop twice.
    const own = (value: T): void => listener(value);
    this.#listeners.add(own);
    listener(this.#value);
    return () => this.#listeners.delete(own);
  }
}
