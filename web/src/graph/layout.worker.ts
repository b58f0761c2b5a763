/// <reference lib="webworker" />
// Places what it is asked to, away from the page's own thread.

import type { Plan } from "./places";
import { Arranger } from "./arrange";

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
