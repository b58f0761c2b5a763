/** Parts of messages. */
import type { Quaternion, Vector } from "../../transforms";

/** A geometry_msgs/Pose. */
export interface Pose {
  readonly position: Vector;
  readonly orientation: Quaternion;
}
