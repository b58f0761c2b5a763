/** One pane of the dashboard: its head, the panel that it shows, and the choice of another one. */
import { cutName, h, replace, setText, svg } from "../dom";
import type { Graph } from "../model";
import { type Config, closePanel, type Panel } from "../panels/panel";
import type { Choice, Chooser } from "./chooser";
import type { Context } from "./context";
import type { Pane, Side } from "./layout";
import { type ViewKind, viewNamed } from "./views";

/** What the pane's buttons do to the layout. */
export interface Changes {
  choose(id: number, view: string, name: string): void;
  split(id: number, side: Side): void;
  move(id: number, at: number, side: Side): void;
  maximize(id: number): void;
  close(id: number): void;
  /** The other panes, to move this one beside them. */
  others(id: number): PaneView[];
}

/** The buttons that split a pane, with their icons. */
const SPLITS: readonly { label: string; path: string; side: Side }[] = [
  { label: "Split right", path: "M2 3h12v10H2z M9 3v10 M11.5 6.5v3 M10 8h3", side: "right" },
  { label: "Split below", path: "M2 3h12v10H2z M2 8.5h12 M8 9.8v2.4 M6.8 11h2.4", side: "below" },
];

export class PaneView {
  readonly element: HTMLElement;
  readonly id: number;
  readonly view: string;
  readonly name: string;
  /** What it shows, in words. */
  readonly title: string;
  panel: Panel | undefined;
  readonly #kind: ViewKind | undefined;
  readonly #config: Config;
  readonly #context: Context;
  readonly #changes: Changes;
  readonly #body = h("div", { class: "pane-body" });
  readonly #notice = h("p", { class: "pane-notice soft", role: "status" });
  readonly #chooser = h("div", { class: "pane-chooser", hidden: true });
  #offers: Chooser | undefined;
  readonly #title: HTMLButtonElement;
  readonly #maximize: HTMLButtonElement;
  /** The type that the panel is for, or that is being loaded. */
  #type: string | undefined;
  #isVisible = false;

  constructor({ id, view, name, config }: Pane, context: Context, changes: Changes) {
    this.id = id;
    this.view = view;
    this.name = name;
    this.#config = config;
    this.#context = context;
    this.#changes = changes;
    this.#kind = viewNamed(view);
    const label = view === "" ? "New panel" : (this.#kind?.label ?? view);
    this.title = `${label} ${name}`.trim();
    const toggle = (): void => this.#toggleChooser();
    this.#title = h(
      "button",
      {
        type: "button",
        class: "quiet pane-title",
        "aria-expanded": "false",
        title: `${this.title}: choose what it shows, or move it`,
        "aria-label": this.title,
        onclick: toggle,
      },
      h("b", {}, label),
      name === "" ? null : cutName(name, "mono ros-name"),
    );
    const button = (text: string, path: string, work: () => void) =>
      h(
        "button",
        { type: "button", class: "quiet", title: text, "aria-label": text, onclick: work },
        icon(path),
      );
    const maximize = (): void => changes.maximize(id);
    const corners = "M2.5 6V2.5H6 M10 2.5h3.5V6 M13.5 10v3.5H10 M6 13.5H2.5V10";
    this.#maximize = button("Maximize", corners, maximize);
    const head = h(
      "header",
      {
        class: "pane-head",
        ondblclick: ({ target }: MouseEvent) => {
          // On a button it is two clicks.
          if (target instanceof Element && target.closest("button") === null) maximize();
        },
      },
      h("h3", {}, this.#title),
      h(
        "div",
        { class: "pane-tools" },
        h(
          "span",
          { class: "pane-splits" },
          ...SPLITS.map(({ label, path, side }) =>
            button(label, path, () => changes.split(id, side)),
          ),
        ),
        this.#maximize,
        button("Close", "M3.5 3.5l9 9 M12.5 3.5l-9 9", () => changes.close(id)),
      ),
    );
    this.element = h(
      "section",
      {
        class: `pane pane-${this.#kind?.name ?? "none"}`,
        "aria-label": this.title,
        tabindex: -1,
        onkeydown: (event: KeyboardEvent) => {
          // Otherwise it ends the large view.
          if (event.key === "Escape" && this.#closeChooser()) event.stopPropagation();
        },
      },
      head,
      this.#chooser,
      this.#body,
    );
  }

  /** The settings of its panel, or those that the panel will get. */
  get config(): Config {
    return this.panel?.config?.() ?? this.#config;
  }

  /** Show the panel, or end its subscriptions. */
  setVisible(visible: boolean): void {
    this.#isVisible = visible;
    this.#showPanel();
  }

  /** Close its panel, which may be loading still. */
  close(): void {
    closePanel(this.panel);
    this.panel = undefined;
    this.#type = undefined;
  }

  /** Whether it fills the dashboard. */
  setLarge(large: boolean): void {
    this.element.classList.toggle("large", large);
    this.#maximize.setAttribute("aria-pressed", String(large));
  }

  /** The graph has changed: what the pane shows may exist by now. */
  update(graph: Graph | null): void {
    if (!this.#chooser.hidden) this.#offers?.show(graph);
    if (this.view === "") {
      if (this.#chooser.hidden) this.#toggleChooser();
      return;
    }
    const type = graph === null ? undefined : this.#kind?.typeOf(graph, this.name);
    // A panel whose topic has gone says so itself, and goes on when it comes back.
    if (type === undefined || type === this.#type) {
      if (this.#type === undefined) this.#showNotice(this.#whyEmpty(graph));
      return;
    }
    this.#type = type;
    void this.#make(type);
  }

  async #make(type: string): Promise<void> {
    const config = this.config;
    closePanel(this.panel);
    this.panel = undefined;
    try {
      const panel = await this.#kind?.make(this.#context, this.name, type, config);
      if (this.#type !== type) closePanel(panel);
      if (this.#type !== type || panel === undefined) return;
      this.panel = panel;
      replace(this.#body, panel.element);
      this.#showPanel();
    } catch (error) {
      // It may load when the graph changes again.
      if (this.#type === type) this.#type = undefined;
      this.#showNotice(`${this.title} could not be loaded: ${(error as Error).message}`);
    }
  }

  #showPanel(): void {
    if (this.#isVisible && this.#chooser.hidden) this.panel?.show();
    else this.panel?.hide();
  }

  #showNotice(text: string): void {
    setText(this.#notice, text);
    if (!this.#notice.isConnected) replace(this.#body, this.#notice);
  }

  #whyEmpty(graph: Graph | null): string {
    if (this.#kind === undefined) {
      return `This page has no view “${this.view}”: a hub of another version may have it.`;
    }
    if (graph === null) return "Waiting for the hub …";
    const topic = graph.topics.find(({ name }) => name === this.name);
    if (topic !== undefined && topic.type !== "") {
      return `${this.title}: the topic has the type ${topic.type}, which this view cannot show.`;
    }
    return `${this.name} does not exist now. It appears here when a node has it.`;
  }

  // The choice of another view.

  #toggleChooser(): void {
    // A pane without a view has nothing else to show.
    this.#chooser.hidden = this.view !== "" && !this.#chooser.hidden;
    const isOpen = !this.#chooser.hidden;
    this.#body.hidden = isOpen;
    this.#title.setAttribute("aria-expanded", String(isOpen));
    if (isOpen) void this.#offer();
    this.#showPanel();
  }

  /** Show the panel again, if there is one; returns whether it was hidden by the choice. */
  #closeChooser(): boolean {
    if (this.view === "" || this.#chooser.hidden) return false;
    this.#toggleChooser();
    this.#title.focus();
    return true;
  }

  async #offer(): Promise<void> {
    const { Chooser, moveForm } = await import("./chooser");
    if (this.#chooser.hidden) return;
    const { id } = this;
    const choose = ({ view, name }: Choice): void => this.#changes.choose(id, view, name);
    this.#offers = new Chooser(this, this.#context.hub.canPublish, choose);
    this.#offers.show(this.#context.model.graph.value);
    replace(
      this.#chooser,
      this.#offers.element,
      moveForm(this.#changes.others(id), (at, side) => {
        this.#changes.move(id, at, side);
        this.#closeChooser();
      }),
      h(
        "div",
        { class: "pane-splits offered" },
        ...SPLITS.map(({ label, side }) =>
          h("button", { type: "button", onclick: () => this.#changes.split(this.id, side) }, label),
        ),
      ),
    );
  }
}

function icon(path: string): SVGElement {
  const line = { fill: "none", stroke: "currentColor", "stroke-width": 1.3 };
  return svg(
    "svg",
    { viewBox: "0 0 16 16", "aria-hidden": "true" },
    svg("path", { d: path, ...line }),
  );
}
