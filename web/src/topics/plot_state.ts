/** The part of a plot that its URL has: curves, and the range of time. */

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
