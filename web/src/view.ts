import type { Hub } from "./hub";
import type { Model } from "./model";

/** One tab of the page. */
export interface View {
  readonly element: HTMLElement;
  /** The view becomes visible. The path is the rest of the route, decoded: `["node", "/talker"]`. */
  show(path: string[]): void;
  /** The view becomes hidden: it ends the subscriptions that it needs only while visible. */
  hide(): void;
}

/** What each folder's `view.ts` exports as `makeView`. */
export type MakeView = (hub: Hub, model: Model) => View;

/** The URL fragment of a view: `route("topics", "/chatter")` is `#/topics/%2Fchatter`. */
export function route(...path: string[]): string {
  return `#/${path.map(encodeURIComponent).join("/")}`;
}

/** The path in a URL fragment, decoded; parts that are invalid stay as they are. */
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
