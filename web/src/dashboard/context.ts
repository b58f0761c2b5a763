import type { Hub } from "../hub";
import type { Model } from "../model";

/** What a view needs to make its panel. */
export interface Context {
  readonly hub: Hub;
  readonly model: Model;
  /** Plot a number beside the other panes. */
  plot(topic: string, path: string): void;
}
