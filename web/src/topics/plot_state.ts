/** A plot as text: the part that its URL has, which is curves and the range of time, and its samples as CSV. */
import { numberText } from "../messages/values";
import type { Sample } from "./ring_buffer";

/** Entries of the URL's state. */
export type ViewState = Record<string, string | boolean>;

/** The topic of a curve and the path of its number. */
export type CurveName = readonly [topic: string, path: string];

/** The ranges of time to choose from. */
export const ranges = {
  all: [
    { seconds: 10, label: "10 s" },
    { seconds: 30, label: "30 s" },
    { seconds: 120, label: "2 min" },
    { seconds: 600, label: "10 min" },
  ],
  usual: "30",
};

/** Curves as text: `/pose:position.x,/joint_states:position[elbow]`. */
export function curvesText(curves: readonly CurveName[]): string {
  // The names of elements may have any characters.
  const escaped = (path: string): string => path.replaceAll("%", "%25").replaceAll(",", "%2C");
  return curves.map(([topic, path]) => `${topic}:${escaped(path)}`).join(",");
}

/** The curves in a text; entries without a topic or a path are left out. */
export function curvesFrom(text: string): CurveName[] {
  return text.split(",").flatMap((entry): CurveName[] => {
    const at = entry.indexOf(":");
    const path = entry
      .slice(at + 1)
      .replaceAll("%2C", ",")
      .replaceAll("%25", "%");
    return at <= 0 || path === "" ? [] : [[entry.slice(0, at), path]];
  });
}

/** A curve, and its samples in the order of time. */
export interface NamedSamples {
  readonly name: CurveName;
  readonly samples: Iterable<Sample>;
}

/**
 * The samples of curves as CSV: a column of times, in seconds since 1970, and one of each curve.
 *
 * Samples of the same time share a row, as those of one message do; gaps are empty. Numbers are as
 * they were sent. Source of the quotes: RFC 4180.
 */
export function csv(curves: readonly NamedSamples[]): string {
  const quoted = (text: string): string => `"${text.replaceAll('"', '""')}"`;
  const lines = [["time", ...curves.map(({ name }) => quoted(name.join(" ")))].join(",")];
  const iterators = curves.map(({ samples }) => samples[Symbol.iterator]());
  const next = iterators.map((each) => take(each));
  for (;;) {
    const time = next.reduce(
      (least, sample) => Math.min(least, sample?.time ?? Infinity),
      Infinity,
    );
    if (time === Infinity) return `${lines.join("\r\n")}\r\n`;
    const values = iterators.map((iterator, curve) => {
      const sample = next[curve];
      if (sample?.time !== time) return "";
      next[curve] = take(iterator);
      return sample.value === undefined ? "" : numberText(sample.value);
    });
    if (values.some((value) => value !== "")) lines.push([time.toFixed(6), ...values].join(","));
  }
}

function take(samples: Iterator<Sample, unknown>): Sample | undefined {
  const { done, value } = samples.next();
  return done ? undefined : value;
}
