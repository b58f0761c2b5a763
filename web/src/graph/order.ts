// What need not move for things to be in another order.

/** Of ranks in the order in which they stand, the most that rise already: all others have to move. */
export function rising(ranks: readonly number[]): Set<number> {
  // At each length the lowest rank that a rising row of that length can end with.
  const ends: number[] = [];
  const before = new Map<number, number | undefined>();
  for (const rank of ranks) {
    let low = 0;
    let high = ends.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if ((ends[middle] as number) < rank) low = middle + 1;
      else high = middle;
    }
    before.set(rank, ends[low - 1]);
    ends[low] = rank;
  }
  const row = new Set<number>();
  for (let rank = ends.at(-1); rank !== undefined; rank = before.get(rank)) row.add(rank);
  return row;
}
