/** Time that is not this computer's: that of /clock, which may go back. */

/** The least step of stamps that counts as time going back, in s: several nodes may take turns. */
const STEP_BACK = 0.1;
/** How long time goes on without a message of /clock, in ms: the one after the next one is late. */
const AHEAD = 1000;

/** The time of /clock. All times are in ms. */
export class SimulatedTime {
  #time: number | undefined;
  #arrived = 0;
  /** Simulated ms in one of this computer's. */
  #speed = 0;

  /** Take the time of a message of /clock. */
  receive(time: number, arrived: number): void {
    const passed = this.#time === undefined ? 0 : time - this.#time;
    this.#speed = arrived > this.#arrived ? Math.max(0, passed) / (arrived - this.#arrived) : 0;
    this.#time = time;
    this.#arrived = arrived;
  }

  /** The time at a time of this computer; `undefined` before the first message of /clock. */
  now(here: number): number | undefined {
    if (this.#time === undefined) return undefined;
    return this.#time + Math.min(AHEAD, this.#speed * (here - this.#arrived));
  }
}

/** The stamps of a topic's messages, which go back when a bag begins again. */
export class Stamps {
  /** In s. */
  #newest = -Infinity;

  /** Take a message's stamp, in s; 0 is none. Returns whether time has gone back. */
  hasGoneBack(stamp: number | undefined): boolean {
    if (stamp === undefined || stamp === 0) return false;
    const isBack = stamp < this.#newest - STEP_BACK;
    this.#newest = isBack ? stamp : Math.max(stamp, this.#newest);
    return isBack;
  }
}
