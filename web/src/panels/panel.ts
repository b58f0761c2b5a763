/** What a panel is: it shows topics of certain types, or publishes on them. */

import type { Model } from "../model";
import type { DataSource } from "../source";
import { own } from "../types";

/** A panel's own settings, as JSON has them: they are part of the dashboard's layouts. */
export type Config = Readonly<Record<string, unknown>>;

/** A view of one topic, on the topic's page for example. */
export interface Panel {
  readonly element: HTMLElement;
  /** The panel becomes visible. */
  show(): void;
  /** The panel becomes hidden: it ends its subscriptions. */
  hide(): void;
  /** The panel is hidden, and will not be shown again: it frees what it has kept so far. */
  close?(): void;
  /** The settings that a new panel is to have if it is to look like this one. */
  config?(): Config;
}

export interface PanelModule {
  /** `config` is what a panel's `config` returned once, or anything that somebody wrote in its place. */
  makePanel(hub: DataSource, model: Model, topic: string, type: string, config?: Config): Panel;
}

/** Hide a panel for good; its elements, listeners and memory are free then. */
export function closePanel(panel: Panel | undefined): void {
  panel?.hide();
  panel?.close?.();
}

/** A number of a panel's settings; undefined if it is none, or out of its range. */
export function numberIn(
  config: Config | undefined,
  name: string,
  low: number,
  high: number,
): number | undefined {
  const value = own(config, name);
  return typeof value === "number" && value >= low && value <= high ? value : undefined;
}
