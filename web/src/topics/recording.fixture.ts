/** Records messages as the worker and a sampler do together. */
import { readerOf } from "./field_readers";
import type { Recorder } from "./sampler";

/** A function that records a message; it returns whether that has nothing to record, but should have. */
export function recording(recorder: Recorder): (message: unknown, time: number) => boolean {
  const reader = readerOf(recorder.wanted);
  return (message, time) => {
    const isMissing = reader.read(message, time);
    const piece = reader.take();
    if (piece !== undefined) recorder.take(piece);
    return isMissing;
  };
}
