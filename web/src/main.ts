/** The page: a connection, a model of the graph, and a view for each tab. */
import { offer } from "./browser_console";
import { h, replace } from "./dom";
import { isHidden } from "./hidden";
import { Hub } from "./hub";
import { Model } from "./model";
import { Shell, TABS, type Tab } from "./shell";
import { type MakeView, pathOf, type View } from "./view";
import { welcome } from "./welcome";

/** Each tab's view is fetched when it is first looked at. */
const MAKERS = import.meta.glob<{ makeView: MakeView }>("./*/view.ts");

const address = new URLSearchParams(location.search).get("hub") ?? ownAddress();
const hub = new Hub(address, new ROSLIB.Ros());
const model = new Model(hub);
const shell = new Shell(hub, model);
const views = new Map<Tab, Promise<View>>();
const greeting = still(
  h(
    "section",
    { class: "welcome-view", "aria-labelledby": "welcome" },
    h("h2", { id: "welcome" }, "This hub is empty"),
    welcome(address),
  ),
);
/** Whether there is nothing but the hub itself and pages. */
let empty = false;
let shown: View | null = null;

offer(address);
window.addEventListener("hashchange", () => void go());
model.graph.watch((graph) => {
  if (graph === null) return;
  const before = empty;
  empty = [...graph.nodes, ...graph.topics].every(({ name }) => isHidden(name));
  if (empty !== before) void go();
});
void go();

/** Show what the address names. */
async function go(): Promise<void> {
  const [first = "graph", ...path] = pathOf(location.hash);
  const tab = TABS.find(({ name }) => name === first)?.name ?? "graph";
  shell.select(tab);
  const hash = location.hash;
  const view = empty && tab === "graph" ? greeting : await viewOf(tab);
  // Another may have been asked for while this one was fetched.
  if (hash !== location.hash || (empty && tab === "graph" && view !== greeting)) return;
  if (shown !== view) {
    shown?.hide();
    replace(shell.stage, view.element);
    shell.stage.dataset.view = tab;
    shown = view;
  }
  view.show(path);
}

function viewOf(tab: Tab): Promise<View> {
  let view = views.get(tab);
  if (view === undefined) {
    view = makeView(tab);
    views.set(tab, view);
    // What could not be fetched may be there at the next try.
    view.catch(() => views.delete(tab));
  }
  return view.catch((error: unknown) => apology(tab, String(error)));
}

async function makeView(tab: Tab): Promise<View> {
  const fetchModule = MAKERS[`./${tab}/view.ts`];
  if (fetchModule === undefined) return apology(tab, "it is not built");
  return (await fetchModule()).makeView(hub, model);
}

function apology(tab: Tab, why: string): View {
  return still(h("section", { class: "empty", role: "alert" }, `There is no ${tab} view: ${why}.`));
}

/** A view that is always the same. */
function still(element: HTMLElement): View {
  return { element, show: () => undefined, hide: () => undefined };
}

function ownAddress(): string {
  const { protocol, host, pathname } = location;
  return `${protocol === "https:" ? "wss" : "ws"}://${host}${pathname.replace(/[^/]*$/, "")}`;
}
