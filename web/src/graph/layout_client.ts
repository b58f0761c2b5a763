/** Requests layouts of pictures from the worker. */
import { layoutWorker } from "../script_urls";
import { type Layout, type LayoutRequest, moved, type Size } from "./layout_types";
import type { Edge, Picture } from "./picture";
import { conflictLabel, type Measure, shortened, sizeOf } from "./shapes";

/** The longest usual labels: there is space for these, so a changing rate moves nothing. */
const RATE = "99.9 Hz";
const LATCHED = `${RATE} latched`;
const PADDING = 4;
const LINE = 15;

interface Response {
  number: number;
  layout?: Layout;
  error?: string;
}

export class LayoutClient {
  readonly #worker: Worker;
  readonly #done: (layout: Layout) => void;
  readonly #failed: (why: string) => void;
  #number = 0;
  #busy = false;
  #queued: LayoutRequest | null = null;

  constructor(done: (layout: Layout) => void, failed: (why: string) => void) {
    this.#done = done;
    this.#failed = failed;
    this.#worker = new Worker(layoutWorker, { type: "module" });
    this.#worker.onmessage = ({ data }: MessageEvent<Response>) => this.#receive(data);
    this.#worker.onerror = ({ message }) => {
      this.#busy = false;
      failed(message || "the worker did not start");
    };
  }

  /** Whether a response is pending. */
  get busy(): boolean {
    return this.#busy;
  }

  /** Request a layout. While the worker is busy, only the last request is queued. */
  request(request: LayoutRequest): void {
    if (this.#busy) {
      this.#queued = request;
      return;
    }
    this.#busy = true;
    this.#number += 1;
    this.#worker.postMessage({ number: this.#number, request });
  }

  /** End the worker. */
  close(): void {
    this.#worker.terminate();
  }

  #receive({ number, layout, error }: Response): void {
    if (number !== this.#number) return;
    this.#busy = false;
    const next = this.#queued;
    this.#queued = null;
    if (next !== null) this.request(next);
    else if (layout !== undefined) this.#done(layout);
    else this.#failed(error ?? "");
  }
}

/** The request for a layout of a picture. */
export function layoutRequest(picture: Picture, measure: Measure, canvas: Size): LayoutRequest {
  return {
    boxes: picture.elements.map((element) => ({
      id: element.id,
      group: element.group,
      ...sizeOf(element, measure),
    })),
    links: picture.edges.map((edge) => ({
      id: edge.id,
      from: edge.from,
      to: edge.to,
      ...labelSize(edge, measure),
    })),
    groups: picture.groups.map(({ name, parent }) => ({
      name,
      parent,
      width: Math.round(measure(name, "rate") + 12),
    })),
    canvas,
  };
}

function labelSize(edge: Edge, measure: Measure): { width: number; height: number } {
  const { conflict, latched, publishers, subscriptions } = edge;
  const isCounted = publishers.length + subscriptions.length > 0;
  if (conflict === "" && !isCounted) return { width: 8, height: 8 };
  const text = conflict !== "" ? conflictLabel(edge) : latched ? LATCHED : RATE;
  const rate = measure(text, "rate");
  if (edge.label === "") return { width: Math.round(rate + PADDING), height: LINE };
  const topic = measure(shortened(edge.label, 32), "rate");
  return { width: Math.round(Math.max(rate, topic) + PADDING), height: 2 * LINE };
}

/** Move a new layout as a whole, so that most of what stayed remains at its place. */
export function anchored(layout: Layout, previous: Layout): Layout {
  const steps = [...layout.boxes].flatMap(([id, { x, y }]) => {
    const before = previous.boxes.get(id);
    return before === undefined ? [] : [{ x: before.x - x, y: before.y - y }];
  });
  return moved(layout, median(steps.map(({ x }) => x)), median(steps.map(({ y }) => y)));
}

function median(numbers: number[]): number {
  const sorted = numbers.sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}
