/** Children of an element that have keys: those that stay keep their element, with its focus and state. */
import { reorder } from "./dom";

export class KeyedRows<T, R extends { readonly element: Element }, K = T> {
  readonly #parent: Element;
  readonly #make: (item: T) => R;
  readonly #keyOf: (item: T) => K;
  readonly #rows = new Map<K, R>();

  /** `make` makes the row of an item; `keyOf` has what identifies it, by default the item itself. */
  constructor(
    parent: Element,
    make: (item: T) => R,
    keyOf: (item: T) => K = (item) => item as unknown as K,
  ) {
    this.#parent = parent;
    this.#make = make;
    this.#keyOf = keyOf;
  }

  /** Show a row for each of some items, in this order, and remove all others. */
  show(items: readonly T[]): void {
    const wanted = new Map(items.map((item) => [this.#keyOf(item), item]));
    for (const [key, { element }] of this.#rows) {
      if (wanted.has(key)) continue;
      element.remove();
      this.#rows.delete(key);
    }
    const elements = Array.from(wanted, ([key, item]) => {
      let row = this.#rows.get(key);
      if (row === undefined) {
        row = this.#make(item);
        this.#rows.set(key, row);
      }
      return row.element;
    });
    reorder(this.#parent, elements);
  }

  /** The row with a key, if it is shown. */
  get(key: K): R | undefined {
    return this.#rows.get(key);
  }

  /** The keys and rows that are shown. */
  entries(): Iterable<[K, R]> {
    return this.#rows.entries();
  }
}
