/** Panels for topics of certain types: pictures of them, or a way to publish on them. */
import { PLAYBACK } from "../bags/names";
import type { Hub } from "../hub";
import type { Model } from "../model";
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
  /** The settings that a new panel is to have if it is to look like this one. */
  config?(): Config;
}

export interface PanelModule {
  /** `config` is what a panel's `config` returned once, or anything that somebody wrote in its place. */
  makePanel(hub: Hub, model: Model, topic: string, type: string, config?: Config): Panel;
}

export interface Kind {
  /** The heading of its section. */
  readonly label: string;
  readonly types: readonly string[];
  /** Whether it is shown instead of Echo: the numbers are many, and nobody reads them. */
  readonly replacesEcho: boolean;
  load(): Promise<PanelModule>;
}

export const KINDS: readonly Kind[] = [
  {
    label: "Picture",
    types: ["sensor_msgs/Image", "sensor_msgs/CompressedImage"],
    replacesEcho: true,
    load: () => import("./image/panel"),
  },
  {
    label: "Map",
    types: ["nav_msgs/OccupancyGrid"],
    replacesEcho: true,
    load: () => import("./image/panel"),
  },
  {
    label: "Diagnostics",
    types: ["diagnostic_msgs/DiagnosticArray"],
    replacesEcho: true,
    load: () => import("./diagnostics/panel"),
  },
  {
    label: "Frames",
    types: ["tf2_msgs/TFMessage", "tf/tfMessage"],
    replacesEcho: true,
    load: () => import("./frames/panel"),
  },
  {
    label: "Playback",
    types: [PLAYBACK],
    replacesEcho: true,
    load: () => import("./playback/panel"),
  },
  {
    label: "Drive",
    types: ["geometry_msgs/Twist", "geometry_msgs/TwistStamped"],
    replacesEcho: false,
    load: () => import("./teleop/panel"),
  },
  {
    label: "Joints",
    types: ["sensor_msgs/JointState"],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    label: "Attitude",
    types: ["sensor_msgs/Imu"],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    label: "Battery",
    types: ["sensor_msgs/BatteryState"],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    label: "Position",
    types: ["sensor_msgs/NavSatFix"],
    replacesEcho: false,
    load: () => import("./readings/panel"),
  },
  {
    label: "Scene",
    types: [
      "sensor_msgs/LaserScan",
      "sensor_msgs/MultiEchoLaserScan",
      "sensor_msgs/PointCloud2",
      "sensor_msgs/PointCloud",
      "sensor_msgs/Range",
      "nav_msgs/OccupancyGrid",
      "nav_msgs/Odometry",
      "nav_msgs/Path",
      "nav_msgs/GridCells",
      "geometry_msgs/PoseStamped",
      "geometry_msgs/PoseWithCovarianceStamped",
      "geometry_msgs/PoseArray",
      "geometry_msgs/PolygonStamped",
      "geometry_msgs/PointStamped",
      "geometry_msgs/WrenchStamped",
      "visualization_msgs/Marker",
      "visualization_msgs/MarkerArray",
      "visualization_msgs/InteractiveMarkerInit",
      "sensor_msgs/CameraInfo",
      "sensor_msgs/JointState",
      "tf2_msgs/TFMessage",
      "tf/tfMessage",
    ],
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
