/** Shows the view that the URL's fragment names. */
import { h, replace } from "./dom";
import type { Model } from "./model";
import type { DataSource } from "./source";
import { type MakeView, pathOf, stateOf, URL_PLACE, type View } from "./view";

/** The modules of the views, each loaded when its tab is first opened. */
const MODULES = import.meta.glob<{ makeView: MakeView }>("./*/view.ts");

export class Navigation<Tab extends string> {
  readonly #stage: HTMLElement;
  readonly #source: DataSource;
  readonly #model: Model;
  readonly #tabs: readonly Tab[];
  readonly #select: (tab: Tab) => void;
  readonly #instead: (tab: Tab) => View | undefined;
  readonly #views = new Map<Tab, Promise<View>>();
  #shown: View | null = null;
  #isEnded = false;

  /**
   * `tabs` begins with the one to show first. `select` is called before the view of a tab is shown;
   * `instead` may return another view for it.
   */
  constructor(
    stage: HTMLElement,
    source: DataSource,
    model: Model,
    tabs: readonly Tab[],
    select: (tab: Tab) => void,
    instead: (tab: Tab) => View | undefined = () => undefined,
  ) {
    this.#stage = stage;
    this.#source = source;
    this.#model = model;
    this.#tabs = tabs;
    this.#select = select;
    this.#instead = instead;
    window.addEventListener("hashchange", this.#onHash);
  }

  readonly #onHash = (): void => void this.navigate();

  /** Hide the view, and follow the fragment no longer. */
  end(): void {
    this.#isEnded = true;
    window.removeEventListener("hashchange", this.#onHash);
    this.#shown?.hide();
  }

  async navigate(): Promise<void> {
    const { hash } = location;
    const [first, ...path] = pathOf(hash);
    const tab = this.#tabs.find((name) => name === first) ?? (this.#tabs[0] as Tab);
    this.#select(tab);
    const view = this.#instead(tab) ?? (await this.#viewOf(tab));
    // The user may have gone on while the view was loading.
    if (hash !== location.hash || this.#isEnded) return;
    if ((this.#instead(tab) ?? view) !== view) return;
    if (this.#shown !== view) {
      this.#shown?.hide();
      replace(this.#stage, view.element);
      this.#stage.dataset.view = tab;
      this.#shown = view;
    }
    view.show(path, stateOf(hash));
  }

  #viewOf(tab: Tab): Promise<View> {
    let view = this.#views.get(tab);
    if (view === undefined) {
      view = this.#load(tab);
      this.#views.set(tab, view);
      // It may succeed at the next try.
      view.catch(() => this.#views.delete(tab));
    }
    return view.catch((error: unknown) => errorView(tab, String(error)));
  }

  async #load(tab: Tab): Promise<View> {
    const load = MODULES[`./${tab}/view.ts`];
    if (load === undefined) return errorView(tab, "it was not built");
    return (await load()).makeView(this.#source, this.#model, URL_PLACE);
  }
}

function errorView(tab: string, why: string): View {
  const text = `The ${tab} view could not be loaded: ${why}.`;
  return staticView(h("section", { class: "empty", role: "alert" }, text));
}

export function staticView(element: HTMLElement, show = (): void => undefined): View {
  return { element, show, hide: () => undefined };
}
