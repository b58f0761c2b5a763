/** The page's entry: connects to the hub and shows the view of the chosen tab. */
import { loadRoslib, offerConsole } from "./browser_console";
import { connectionProblem } from "./connection_problem";
import { h, replace } from "./dom";
import { isHidden } from "./hidden_names";
import { Hub, hubUrl, splitToken } from "./hub";
import { Login, loginForm } from "./login";
import { HubModel } from "./model";
import { Shell, TABS, type Tab } from "./shell";
import { type MakeView, pathOf, stateOf, type View } from "./view";
import { welcome } from "./welcome";

/** The modules of the views, each loaded when its tab is first opened. */
const MODULES = import.meta.glob<{ makeView: MakeView }>("./*/view.ts");

try {
  start(address());
} catch (error) {
  replace(document.body, invalidAddress((error as Error).message));
}

/** Show the hub at a WebSocket address. */
function start(address: string): void {
  const { url, token } = splitToken(address);
  const hub = new Hub(url, token);
  const login = new Login(hub);
  const model = new HubModel(hub);
  const shell = new Shell(hub, model, login);
  shell.stage.before(connectionProblem(hub), loginForm(hub, login));
  void login.identify();
  const views = new Map<Tab, Promise<View>>();
  const welcomeView = staticView(
    h(
      "section",
      { class: "welcome-view", "aria-labelledby": "welcome" },
      h("h2", { id: "welcome" }, "This hub is empty"),
      welcome(url),
    ),
    loadRoslib,
  );
  /** Whether the hub has no nodes and topics besides its own and those of pages. */
  let isEmpty = false;
  let shown: View | null = null;
  let hasTimeBar = false;

  /** Show the view that the URL fragment names. */
  async function navigate(): Promise<void> {
    const { hash } = location;
    const [first = "graph", ...path] = pathOf(hash);
    const tab = TABS.find(({ name }) => name === first)?.name ?? "graph";
    shell.select(tab);
    if (tab !== "graph") void showTimeBar();
    const view = isEmpty && tab === "graph" ? welcomeView : await viewOf(tab);
    // The user may have gone on while the view was loading.
    if (hash !== location.hash || (isEmpty && tab === "graph" && view !== welcomeView)) return;
    if (shown !== view) {
      shown?.hide();
      replace(shell.stage, view.element);
      shell.stage.dataset.view = tab;
      shown = view;
    }
    view.show(path, stateOf(hash));
  }

  /** Keep messages from the first view on that shows some, and offer to go back. */
  async function showTimeBar(): Promise<void> {
    if (hasTimeBar) return;
    hasTimeBar = true;
    hub.data.send({ kind: "keep" });
    const { TimeBar } = await import("./timebar/bar");
    shell.stage.after(new TimeBar(hub.clock, hub.data, model, false).element);
  }

  function viewOf(tab: Tab): Promise<View> {
    let view = views.get(tab);
    if (view === undefined) {
      view = loadView(tab);
      views.set(tab, view);
      // It may succeed at the next try.
      view.catch(() => views.delete(tab));
    }
    return view.catch((error: unknown) => errorView(tab, String(error)));
  }

  async function loadView(tab: Tab): Promise<View> {
    const load = MODULES[`./${tab}/view.ts`];
    if (load === undefined) return errorView(tab, "it was not built");
    return (await load()).makeView(hub, model);
  }

  window.addEventListener("hashchange", () => void navigate());
  model.graph.watch((graph) => {
    if (graph === null) return;
    const wasEmpty = isEmpty;
    isEmpty = [...graph.nodes, ...graph.topics].every(({ name }) => isHidden(name));
    if (isEmpty !== wasEmpty) void navigate();
  });
  offerConsole(url);
  void navigate();
}

/** The hub's address: that of this page, unless `?hub=robot:9090` names another. */
function address(): string {
  const { protocol, host, pathname, search } = location;
  const secure = protocol === "https:";
  const other = new URLSearchParams(search).get("hub")?.trim();
  if (other) return hubUrl(other, secure);
  return `${secure ? "wss" : "ws"}://${host}${pathname.replace(/[^/]*$/, "")}`;
}

function invalidAddress(problem: string): HTMLElement {
  return h(
    "main",
    { class: "empty", role: "alert" },
    h("p", {}, `${problem}.`),
    h("p", {}, h("a", { href: location.pathname }, "Show the hub of this page")),
  );
}

function errorView(tab: Tab, why: string): View {
  const text = `The ${tab} view could not be loaded: ${why}.`;
  return staticView(h("section", { class: "empty", role: "alert" }, text));
}

function staticView(element: HTMLElement, show = (): void => undefined): View {
  return { element, show, hide: () => undefined };
}
