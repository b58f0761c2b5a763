/** A plot as text: the part that its URL has, which is curves and settings, and its samples as CSV. */
import { greatest } from "../lists";
import { numberText } from "../messages/values";
import type { Sample } from "./ring_buffer";

/** Entries of the URL's state. */
export type ViewState = Record<string, string | boolean>;

/** The topic of a curve and the expression of its number. */
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

/** A curve, and the elements of its array. */
export interface NamedElements {
  readonly name: CurveName;
  readonly elements: ArrayLike<number>;
}

/** The elements of arrays as CSV: a column of indices, and one of each array; of a part of the indices. */
export function elementsCsv(
  curves: readonly NamedElements[],
  from = 0,
  to = Number.POSITIVE_INFINITY,
): string {
  const lines = [["index", ...curves.map(({ name }) => quoted(name.join(" ")))].join(",")];
  const count = greatest(
    curves.map(({ elements }) => elements.length),
    0,
  );
  for (let at = Math.max(0, Math.ceil(from)); at < count && at <= to; at += 1) {
    const values = curves.map(({ elements }) => elements[at]);
    lines.push(
      [at, ...values.map((each) => (each === undefined ? "" : numberText(each)))].join(","),
    );
  }
  return `${lines.join("\r\n")}\r\n`;
}

function quoted(text: string): string {
  return `"${text.replaceAll('"', '""')}"`;
}

function take(samples: Iterator<Sample, unknown>): Sample | undefined {
  const { done, value } = samples.next();
  return done ? undefined : value;
}
