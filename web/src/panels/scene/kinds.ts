/** The kinds of layers: to add one, add it to this list. */
import type { LayerKind } from "./layer";
import { FRAMES } from "./layers/frames";
import { LASER_SCAN } from "./layers/laser_scan";

export const LAYER_KINDS: readonly LayerKind[] = [FRAMES, LASER_SCAN];
