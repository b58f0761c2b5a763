/** What `Math.min`, `Math.max` and `push` cannot do with lists that do not fit on the stack. */

/** The least of some numbers, and of `start`; NaN if one of them is. */
export function least(numbers: Iterable<number>, start = Infinity): number {
  let found = start;
  for (const number of numbers) found = Math.min(found, number);
  return found;
}

/** The greatest of some numbers, and of `start`; NaN if one of them is. */
export function greatest(numbers: Iterable<number>, start = -Infinity): number {
  let found = start;
  for (const number of numbers) found = Math.max(found, number);
  return found;
}

/** Add elements at the end of a list. */
export function append<T>(list: T[], more: Iterable<T>): void {
  for (const each of more) list.push(each);
}
