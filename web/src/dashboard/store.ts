/**
 * Where layouts are kept: in this browser, and for everybody in a parameter of the hub.
 *
 * The browser keeps what is on the screen at once; the hub gets a layout only when somebody saves it.
 */

import { ParameterServer } from "../parameters/parameters";
import type { DataSource } from "../source";
import { own } from "../types";
import { fromFile, isSame, type Layout, toFile } from "./layout";

/** The namespace of shared layouts; their values are texts of files. */
const SHARED = "/fibws/layouts";

export class LayoutStore {
  /** The name of the layout that is shown; empty for the one without. */
  name = "";
  /** Whether nobody has changed what was made from the graph: more may be added to it. */
  isAuto = false;
  /** The shared layout that the shown one was made from, as a text; empty if there is none. */
  #base = "";
  /** The texts of the shared layouts by their names. */
  #shared = new Map<string, string>();
  readonly #prefix: string;
  readonly #parameters: ParameterServer;

  constructor(hub: DataSource) {
    this.#prefix = `fibws.layout ${hub.url} `;
    this.#parameters = new ParameterServer(hub);
  }

  /** The names of layouts that only this browser has. */
  get ownNames(): string[] {
    return attempt(() => Object.keys(localStorage), [])
      .filter((key) => key.startsWith(this.#prefix) && key !== this.#prefix)
      .map((key) => key.slice(this.#prefix.length))
      .filter((name) => !this.#shared.has(name))
      .sort();
  }

  get sharedNames(): string[] {
    return [...this.#shared.keys()].sort();
  }

  has(name: string): boolean {
    return this.#shared.has(name) || this.ownNames.includes(name);
  }

  isShared(name = this.name): boolean {
    return this.#shared.has(name);
  }

  /** Return the layout of a name in this browser, which is the shown one from now on. */
  open(name: string): Layout | null {
    this.name = name;
    this.#base = "";
    const found = attempt(() => {
      const text = localStorage.getItem(this.#prefix + name);
      if (text === null) return undefined;
      const file: unknown = JSON.parse(text);
      const { layout } = fromFile(text);
      this.#base = String(own(file, "base") ?? "");
      return { layout, isAuto: own(file, "auto") === true };
    }, undefined);
    this.isAuto = name === "" && (found?.isAuto ?? true);
    return found?.layout ?? null;
  }

  /** Keep the shown layout in this browser. */
  keep(layout: Layout | null): void {
    const file = JSON.parse(toFile(this.name, layout)) as object;
    const text = JSON.stringify({ ...file, base: this.#base, auto: this.isAuto });
    // A browser that keeps nothing has the layout until the page is closed.
    attempt(() => localStorage.setItem(this.#prefix + this.name, text), undefined);
  }

  /** Get the shared layouts of the hub; throws an `Error` if it refuses that. */
  async loadShared(): Promise<void> {
    const found: unknown = JSON.parse(await this.#parameters.get(SHARED, "{}"));
    const texts = Object.entries(typeof found === "object" ? (found ?? {}) : {});
    this.#shared = new Map(
      texts.filter((entry): entry is [string, string] => typeof entry[1] === "string"),
    );
  }

  /** Whether the shown layout differs from the shared one that it was made from. */
  isChanged(layout: Layout | null): boolean {
    if (this.#base === "") return layout !== null;
    return attempt(() => !isSame(fromFile(this.#base).layout, layout), true);
  }

  /** Whether the shared layout has changed since the shown one was made from it. */
  get isOutdated(): boolean {
    return this.isShared() && this.#shared.get(this.name) !== this.#base;
  }

  /** Show the shared layout of the name: return it. Throws a `LayoutError` if it is none. */
  takeShared(): Layout | null {
    const text = this.#shared.get(this.name) ?? "";
    const { layout } = fromFile(text);
    this.#base = text;
    this.isAuto = false;
    this.#forget(this.name);
    return layout;
  }

  /**
   * Save a layout under a name, in this browser or for everybody.
   *
   * Throws an `Error` if the hub refuses that.
   */
  async save(name: string, layout: Layout | null, isForAll: boolean): Promise<void> {
    const text = toFile(name, layout);
    if (isForAll) {
      await this.#parameters.set(`${SHARED}/${name}`, JSON.stringify(text));
      this.#shared.set(name, text);
      this.#forget(name);
      if (name === this.name) this.#base = text;
    } else {
      const base = this.#shared.get(name) ?? "";
      const file = JSON.stringify({ ...(JSON.parse(text) as object), base });
      attempt(() => localStorage.setItem(this.#prefix + name, file), undefined);
    }
  }

  /** Delete a layout here, and on the hub if it is shared; throws an `Error` if that refuses. */
  async remove(name: string): Promise<void> {
    if (this.#shared.has(name)) await this.#parameters.remove(`${SHARED}/${name}`);
    this.#shared.delete(name);
    this.#forget(name);
  }

  #forget(name: string): void {
    attempt(() => localStorage.removeItem(this.#prefix + name), undefined);
  }
}

/** The result of a function, or another one if it fails: browsers may forbid to keep anything. */
function attempt<T>(work: () => T, otherwise: T): T {
  try {
    return work();
  } catch {
    return otherwise;
  }
}
