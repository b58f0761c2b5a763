/** The panels that there are, and the types of the topics that they are for. */
import { PLAYBACK } from "../bags/names";
import type { PanelModule } from "./panel";
import { READING_TYPES } from "./readings/types";
import { SCENE_TYPES } from "./scene/types";

export interface Kind {
  /** Its name in layouts, which stays. */
  readonly id: string;
  /** The heading of its section. */
  readonly label: string;
  readonly types: readonly string[];
  /** Whether it is shown instead of Echo: the numbers are many, and nobody reads them. */
  readonly replacesEcho: boolean;
  /** Whether it is there to publish: a recording takes nothing. */
  readonly publishes?: boolean;
  load(): Promise<PanelModule>;
}

export const KINDS: readonly Kind[] = [
  {
    id: "image",
    label: "Image",
    types: ["sensor_msgs/Image", "sensor_msgs/CompressedImage"],
    replacesEcho: true,
    load: () => import("./image/panel"),
  },
  {
    id: "map",
    label: "Map",
    types: ["nav_msgs/OccupancyGrid"],
    replacesEcho: true,
    load: () => import("./image/panel"),
  },
  {
    id: "diagnostics",
    label: "Diagnostics",
    types: ["diagnostic_msgs/DiagnosticArray"],
    replacesEcho: true,
    load: () => import("./diagnostics/panel"),
  },
  {
    id: "transforms",
    label: "Transform tree",
    types: ["tf2_msgs/TFMessage", "tf/tfMessage"],
    replacesEcho: true,
    load: () => import("./frames/panel"),
  },
  {
    id: "playback",
    label: "Playback",
    types: [PLAYBACK],
    replacesEcho: true,
    load: () => import("./playback/panel"),
  },
  {
    id: "teleop",
    label: "Teleop",
    types: ["geometry_msgs/Twist", "geometry_msgs/TwistStamped"],
    replacesEcho: false,
    publishes: true,
    load: () => import("./teleop/panel"),
  },
  {
    id: "joints",
    label: "Joints",
    types: [READING_TYPES.joints],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    id: "attitude",
    label: "Attitude",
    types: [READING_TYPES.attitude],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    id: "battery",
    label: "Battery",
    types: [READING_TYPES.battery],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    id: "position",
    label: "Position",
    types: [READING_TYPES.position],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    id: "3d",
    label: "3D",
    types: SCENE_TYPES,
    replacesEcho: true,
    load: () => import("./scene/panel"),
  },
];

/** The kinds of panels for a type. */
export function kindsFor(type: string): readonly Kind[] {
  return KINDS.filter(({ types }) => types.includes(type));
}

/** The first kind of panel for a type, if it has one. */
export function kindFor(type: string): Kind | undefined {
  return KINDS.find(({ types }) => types.includes(type));
}
