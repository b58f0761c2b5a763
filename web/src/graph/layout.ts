// Asks the worker for places; of several questions only the last one's answer counts.

import { layoutWorker } from "../worker_url";
import type { Places, Plan } from "./places";

interface Answer {
  round: number;
  places?: Places;
  error?: string;
}

export class Layout {
  readonly #worker: Worker;
  readonly #placed: (places: Places) => void;
  readonly #failed: (why: string) => void;
  #round = 0;
  #busy = false;
  #next: Plan | null = null;

  constructor(placed: (places: Places) => void, failed: (why: string) => void) {
    this.#placed = placed;
    this.#failed = failed;
    this.#worker = new Worker(layoutWorker, { type: "module" });
    this.#worker.onmessage = ({ data }: MessageEvent<Answer>) => this.#answer(data);
    this.#worker.onerror = ({ message }) => {
      this.#busy = false;
      failed(message || "the worker did not start");
    };
  }

  /** Whether an answer is awaited. */
  get busy(): boolean {
    return this.#busy;
  }

  /** Place this, as soon as what is being placed now is done. */
  ask(plan: Plan): void {
    if (this.#busy) {
      this.#next = plan;
      return;
    }
    this.#busy = true;
    this.#round += 1;
    this.#worker.postMessage({ round: this.#round, plan });
  }

  #answer({ round, places, error }: Answer): void {
    if (round !== this.#round) return;
    this.#busy = false;
    const next = this.#next;
    this.#next = null;
    if (next !== null) this.ask(next);
    else if (places !== undefined) this.#placed(places);
    else this.#failed(error ?? "");
  }
}
