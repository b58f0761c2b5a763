/// <reference lib="webworker" />
// Lays out graphs off the main thread.

import { LayoutEngine } from "./layout";
import type { LayoutRequest } from "./layout_types";

declare const self: DedicatedWorkerGlobalScope;

const engine = new LayoutEngine();

self.onmessage = ({ data }: MessageEvent<{ number: number; request: LayoutRequest }>): void => {
  const { number, request } = data;
  try {
    self.postMessage({ number, layout: engine.layOut(request) });
  } catch (error) {
    self.postMessage({ number, error: String(error) });
  }
};
