/** Which flows had messages lately: the graph can hide the others. */

import type { Rates } from "../model";

/** Flows without messages for this time are quiet, in ms. */
const QUIET_AFTER = 30_000;

export class Traffic {
  /** By `flowKey`, the time of the latest messages in ms. */
  readonly #latest = new Map<string, number>();

  /** Record the flows of new rates; returns whether other flows are busy than before. */
  record({ publishers, subscriptions }: Rates, now: number): boolean {
    let isChanged = false;
    for (const flows of [publishers, subscriptions]) {
      for (const [flow, { messages }] of flows) {
        if (messages === 0) continue;
        isChanged ||= !this.#latest.has(flow);
        this.#latest.set(flow, now);
      }
    }
    for (const [flow, since] of this.#latest) {
      if (now - since < QUIET_AFTER) continue;
      this.#latest.delete(flow);
      isChanged = true;
    }
    return isChanged;
  }

  isBusy(flow: string): boolean {
    return this.#latest.has(flow);
  }
}
