/// <reference lib="webworker" />
// Places what it is asked to, away from the page's own thread.

import { Arranger } from "./arrange";
import type { Plan } from "./places";

declare const self: DedicatedWorkerGlobalScope;

const arranger = new Arranger();

self.onmessage = ({ data }: MessageEvent<{ round: number; plan: Plan }>): void => {
  const { round, plan } = data;
  try {
    self.postMessage({ round, places: arranger.arrange(plan) });
  } catch (error) {
    self.postMessage({ round, error: String(error) });
  }
};
