/** Where the states of a track are on the screen. */
import type { Change } from "./sample_messages";
import type { StateTrack } from "./state_track";

/** From one position to another one, in pixels, with the number of its colour. */
export interface Span {
  readonly left: number;
  readonly right: number;
  readonly state: string;
  readonly colour: number;
}

/**
 * The spans of a track between two times, on so many pixels.
 *
 * Each is at least a pixel wide; of several within one pixel, the first is seen.
 */
export function spansOf(track: StateTrack, from: number, to: number, pixels: number): Span[] {
  const { changes, states } = track;
  const place = (time: number): number =>
    Math.min(pixels, Math.max(0, Math.floor(((time - from) / (to - from)) * pixels)));
  const spans: Span[] = [];
  let end = 0;
  for (let at = Math.max(0, track.indexAt(from)); at < changes.length; at += 1) {
    const { time, state } = changes[at] as Change;
    if (time >= to) break;
    const own = place(time);
    const left = Math.max(own, end);
    const right = Math.max(own + 1, place(changes[at + 1]?.time ?? to));
    if (right <= left) continue;
    end = right;
    if (state !== undefined) spans.push({ left, right, state, colour: states.get(state) ?? 0 });
  }
  return spans;
}
