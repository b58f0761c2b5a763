/** The kinds of layers: to add one, add it to this list. */
import type { LayerKind } from "./layer";
import { FRAMES } from "./layers/frames";
import { LASER_SCAN } from "./layers/laser_scan";
import { GRID_CELLS, PATH, POLYGON } from "./layers/lines";
import { OCCUPANCY_GRID } from "./layers/occupancy_grid";
import { POINT_CLOUD } from "./layers/point_cloud";
import { ODOMETRY, POSE, POSE_ARRAY } from "./layers/poses";
import { POINT, RANGE, VECTORS } from "./layers/readings";

/** In the order of the list of layers. */
export const LAYER_KINDS: readonly LayerKind[] = [
  OCCUPANCY_GRID,
  LASER_SCAN,
  POINT_CLOUD,
  FRAMES,
  ODOMETRY,
  PATH,
  POSE,
  POSE_ARRAY,
  POLYGON,
  GRID_CELLS,
  POINT,
  RANGE,
  VECTORS,
];
