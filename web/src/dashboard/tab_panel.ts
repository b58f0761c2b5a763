/** A tab of the page as a panel: its view, which keeps its state in the layout in place of the URL. */
import type { Config, Panel } from "../panels/panel";
import { type MakeView, pathOf, stateOf } from "../view";
import type { Context } from "./context";

/** `tab` is the tab's name in links, which the panel follows itself. */
export function tabPanel(
  makeView: MakeView,
  tab: string,
  { hub, model }: Context,
  config: Config,
): Panel {
  let state: Config = config;
  let isFirst = true;
  let path: string[] = [];
  const show = (next: string[], query: URLSearchParams | null): void => {
    path = next;
    view.show(path, query);
  };
  const view = makeView(hub, model, {
    save(next) {
      const kept = Object.entries(next).filter(([, value]) => value !== "" && value !== false);
      state = Object.fromEntries(kept);
    },
    go: (_tab, ...rest) => show(rest, null),
  });
  view.element.classList.add("tab-panel");
  view.element.addEventListener("click", (event) => {
    const link = event.target instanceof Element ? event.target.closest("a") : null;
    if (link === null || event.ctrlKey || event.metaKey || event.shiftKey) return;
    const [to, ...rest] = pathOf(link.hash);
    if (to !== tab) return;
    event.preventDefault();
    show(rest, stateOf(link.hash));
  });
  return {
    element: view.element,
    show() {
      show(path, isFirst ? query(config) : null);
      isFirst = false;
    },
    hide: () => view.hide(),
    close: () => view.close?.(),
    config: () => state,
  };
}

/** Settings as the state in a URL. */
export function query(config: Config): URLSearchParams {
  const state = new URLSearchParams();
  for (const [name, value] of Object.entries(config)) {
    if (typeof value === "string" && value !== "") state.set(name, value);
    if (value === true) state.set(name, "1");
  }
  return state;
}
