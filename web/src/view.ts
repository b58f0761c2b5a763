import type { Hub } from "./hub";
import type { Model } from "./model";

/** One tab of the page. */
export interface View {
  readonly element: HTMLElement;
  /** Comes into sight; the path is the rest of the route, decoded: `["node", "/talker"]`. */
  show(path: string[]): void;
  /** Goes out of sight, and ends every subscription that only the sight of it needs. */
  hide(): void;
}

/** What each folder's `view.ts` exports as `makeView`. */
export type MakeView = (hub: Hub, model: Model) => View;

/** The address of a view: `route("topics", "/chatter")` is `#/topics/%2Fchatter`. */
export function route(...path: string[]): string {
  return `#/${path.map(encodeURIComponent).join("/")}`;
}

/** The path that an address names, decoded; what cannot be decoded stands as it is. */
export function pathOf(hash: string): string[] {
  return hash
    .replace(/^#\/?/, "")
    .split("/")
    .filter((part) => part !== "")
    .map((part) => {
      try {
        return decodeURIComponent(part);
      } catch {
        return part;
      }
    });
}
