import type { Model } from "../model";
import type { DataSource } from "../source";

/** What a view needs to make its panel. */
export interface Context {
  readonly hub: DataSource;
  readonly model: Model;
  /** Plot a number beside the other panes. */
  plot(topic: string, path: string): void;
}
