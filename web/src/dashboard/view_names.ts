/** The names of views in layouts: those of the field, and what earlier versions called them. */

const EARLIER: Readonly<Record<string, string>> = {
  picture: "image",
  drive: "teleop",
  scene: "3d",
  frames: "transforms",
  echo: "raw",
};

/** The name of a view by which layouts are saved now. */
export function currentName(view: string): string {
  return Object.hasOwn(EARLIER, view) ? (EARLIER[view] as string) : view;
}

/** What a view was called, so that it is found by that, too. */
export function earlierNames(view: string): string[] {
  return Object.keys(EARLIER).filter((name) => EARLIER[name] === view);
}
