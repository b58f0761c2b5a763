import type { Model } from "./model";
import type { DataSource } from "./source";

/** One tab of the page. */
export interface View {
  readonly element: HTMLElement;
  /**
   * The view becomes visible, or its URL changes.
   *
   * `path` is the rest of the route, decoded: `["node", "/talker"]`. `state` is the state in the URL,
   * such as the filter; without one, the view keeps its state. The view writes it by `saveState`.
   */
  show(path: string[], state: URLSearchParams | null): void;
  /** The view becomes hidden: it ends the subscriptions that it needs only while visible. */
  hide(): void;
  /** The view is hidden, and will not be shown again: it frees what it has. */
  close?(): void;
}

/** Where a view is: the page's URL has its state and its path, or a panel. */
export interface Place {
  save(state: Record<string, string | boolean>): void;
  /** Show a path, which begins with the name of the view's tab. */
  go(...path: string[]): void;
}

/** What each folder's `view.ts` exports as `makeView`. */
export type MakeView = (hub: DataSource, model: Model, place: Place) => View;

/** The URL fragment of a view: `route("topics", "/chatter")` is `#/topics/%2Fchatter`. */
export function route(...path: string[]): string {
  return `#/${path.map(encodeURIComponent).join("/")}`;
}

/** The state in a URL fragment: `#/topics?filter=scan`; null if there is none. */
export function stateOf(hash: string): URLSearchParams | null {
  const [, query] = hash.split("?", 2);
  return query === undefined ? null : new URLSearchParams(query);
}

/** A URL fragment with another state; entries that are empty or false are left out. */
export function withState(hash: string, state: Record<string, string | boolean>): string {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(state)) {
    if (value !== "" && value !== false) query.set(name, value === true ? "1" : value);
  }
  const path = hash.replace(/\?.*$/s, "");
  // Slashes are allowed in a fragment, and names are easier to read with them.
  const text = query.toString().replaceAll("%2F", "/").replaceAll("%2C", ",");
  return text === "" ? path : `${path || "#/"}?${text}`;
}

/** The URL: a link to it or a reload restores the state of the shown view. */
export const URL_PLACE: Place = {
  save(state) {
    const hash = withState(location.hash, state);
    if (hash !== location.hash) {
      history.replaceState(history.state, "", `${location.pathname}${location.search}${hash}`);
    }
  },
  go(...path) {
    location.hash = route(...path);
  },
};

/** The path in a URL fragment, decoded; parts that are invalid stay as they are. */
export function pathOf(hash: string): string[] {
  return hash
    .replace(/^#\/?/, "")
    .replace(/\?.*$/s, "")
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
