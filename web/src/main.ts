/** The page's entry: connects to the hub, or opens a recording, and shows the view of the chosen tab. */
import { loadRoslib, offerConsole } from "./browser_console";
import { connectionProblem } from "./connection_problem";
import { h, replace } from "./dom";
import { isHidden } from "./hidden_names";
import { Hub, hubUrl, splitToken } from "./hub";
import { Login } from "./login";
import type { Origin } from "./messages/recording_messages";
import { HubModel } from "./model";
import { Navigation, staticView } from "./navigation";
import { Shell, TABS, type Tab } from "./shell";

/** Ends what is shown, before a recording takes its place. */
let end = (): void => undefined;

const query = new URLSearchParams(location.search);
const file = query.get("file");
if (file) void open({ url: new URL(file, location.href).href, token: "" });
else {
  try {
    start(address());
  } catch (error) {
    replace(document.body, invalidAddress((error as Error).message));
  }
}
document.addEventListener("dragover", (event) => {
  if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
});
document.addEventListener("drop", (event) => {
  if (!event.dataTransfer?.types.includes("Files")) return;
  event.preventDefault();
  // They must be asked for at once, and are read afterwards.
  const entries = [...event.dataTransfer.items].flatMap(
    (item) => item.webkitGetAsEntry() ?? item.getAsFile() ?? [],
  );
  void import("./dropped_files")
    .then(({ filesOf }) => filesOf(entries))
    .then(open, (error) => console.error(error));
});

/** Show a recording. */
async function open(origin: Origin): Promise<void> {
  const { showRecording } = await import("./file_page");
  end();
  end = showRecording(origin, open);
}

/** Show the hub at a WebSocket address. */
function start(address: string): void {
  const { url, token } = splitToken(address);
  const hub = new Hub(url, token);
  const login = new Login(hub);
  const model = new HubModel(hub);
  const shell = new Shell(hub, model, login, open);
  shell.stage.before(connectionProblem(hub));
  let isAsked = false;
  hub.denied.watch((why) => {
    if (why === "" || isAsked) return;
    isAsked = true;
    void import("./login_form").then(({ loginForm }) => shell.stage.before(loginForm(hub, login)));
  });
  void login.identify();
  const steps = h(
    "section",
    { class: "welcome-view", "aria-labelledby": "welcome" },
    h("h2", { id: "welcome" }, "This hub is empty"),
  );
  const welcomeView = staticView(steps, () => {
    loadRoslib();
    if (steps.children.length > 1) return;
    void import("./welcome").then(({ welcome }) => steps.append(welcome(url)));
  });
  /** Whether the hub has no nodes and topics besides its own and those of pages. */
  let isEmpty = false;
  let hasTimeBar = false;

  /** Keep messages from the first view on that shows some, and offer to go back. */
  async function showTimeBar(): Promise<void> {
    if (hasTimeBar) return;
    hasTimeBar = true;
    hub.data.send({ kind: "keep" });
    const { TimeBar } = await import("./timebar/bar");
    shell.stage.after(new TimeBar(hub.clock, hub.data, model, false).element);
  }

  function select(tab: Tab): void {
    shell.select(tab);
    if (tab !== "graph") void showTimeBar();
  }

  const navigation = new Navigation(
    shell.stage,
    hub,
    model,
    TABS.map(({ name }) => name),
    select,
    (tab) => (isEmpty && tab === "graph" ? welcomeView : undefined),
  );
  model.graph.watch((graph) => {
    if (graph === null) return;
    const wasEmpty = isEmpty;
    isEmpty = [...graph.nodes, ...graph.topics].every(({ name }) => isHidden(name));
    if (isEmpty !== wasEmpty) void navigation.navigate();
  });
  offerConsole(url);
  void navigation.navigate();
  end = () => {
    navigation.end();
    hub.end();
  };
}

/** The hub's address: that of this page, unless `?hub=robot:9090` names another. */
function address(): string {
  const { protocol, host, pathname } = location;
  const secure = protocol === "https:";
  const other = query.get("hub")?.trim();
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
