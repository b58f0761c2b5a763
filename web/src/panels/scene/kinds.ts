/** The kinds of layers: to add one, add it to the list at the end. */
import type { Layer, LayerContext, LayerKind, Setting } from "./layer";
import { Frames } from "./layers/frames";
import { LaserScan } from "./layers/laser_scan";
import { OccupancyGrid } from "./layers/occupancy_grid";
import { LAYER_TYPES } from "./types";

const color = (value: string): Setting => ({ name: "color", label: "Colour", value });

const width: Setting = { name: "width", label: "Width (px)", value: 3, min: 1, max: 8, step: 1 };
const shape: Setting = {
  name: "shape",
  label: "Shape",
  value: "arrow",
  options: ["arrow", "axes"],
};
const covariance: Setting = { name: "covariance", label: "Covariance (95 %)", value: true };
const size = (value: number): Setting => ({
  name: "size",
  label: "Size (m)",
  value,
  min: 0.01,
  max: 10,
  step: 0.05,
});

const OCCUPANCY_GRID: LayerKind = {
  id: "map",
  label: "Map",
  types: LAYER_TYPES.map,
  throttle: 50,
  isFirst: true,
  isContext: true,
  updates: (topic) => ({ topic: `${topic}_updates`, type: "map_msgs/OccupancyGridUpdate" }),
  settings: [
    { name: "palette", label: "Colours", value: "map", options: ["map", "costmap", "raw"] },
    { name: "alpha", label: "Opacity", value: 0.8, min: 0, max: 1, step: 0.1 },
  ],
  make: (context) => new OccupancyGrid(context),
};

const LASER_SCAN: LayerKind = {
  id: "laserScan",
  label: "Laser scan",
  types: LAYER_TYPES.laserScan,
  throttle: 20,
  isStream: true,
  isFirst: true,
  settings: [
    { name: "color", label: "Colour", value: "flat", options: ["flat", "range", "intensity"] },
    { name: "flat", label: "Flat colour", value: "#e5484d" },
    { name: "palette", label: "Palette", value: "turbo", options: ["turbo", "viridis", "grey"] },
    { name: "size", label: "Point size (px)", value: 3, min: 1, max: 12, step: 1 },
    { name: "decay", label: "Decay (s)", value: 0, min: 0, max: 10, step: 0.5 },
  ],
  make: (context) => new LaserScan(context),
};

const POINT_CLOUD: LayerKind = {
  id: "pointCloud",
  label: "Point cloud",
  types: LAYER_TYPES.pointCloud,
  throttle: 30,
  isStream: true,
  isFirst: true,
  settings: [
    {
      name: "color",
      label: "Colour",
      value: "auto",
      options: ["auto", "rgb", "field", "z", "flat"],
    },
    { name: "field", label: "Field", value: "intensity" },
    { name: "flat", label: "Flat colour", value: "#3e8ef7" },
    { name: "palette", label: "Palette", value: "turbo", options: ["turbo", "viridis", "grey"] },
    { name: "isAuto", label: "Range by the values", value: true },
    { name: "low", label: "From", value: 0, step: 0.1 },
    { name: "high", label: "To", value: 1, step: 0.1 },
    { name: "size", label: "Point size (px)", value: 2, min: 1, max: 8, step: 1 },
    { name: "decay", label: "Decay (s)", value: 0, min: 0, max: 10, step: 0.5 },
  ],
  make: async (context) => new (await import("./layers/point_cloud")).PointCloud(context),
};

const FRAMES: LayerKind = {
  id: "frames",
  label: "Frames (tf)",
  types: LAYER_TYPES.frames,
  throttle: 0,
  isOwn: true,
  isFirst: true,
  isContext: true,
  settings: [
    { name: "names", label: "Names", value: true },
    { name: "lines", label: "Lines to parents", value: true },
    { name: "size", label: "Axes (m)", value: 0.3, min: 0.01, max: 10, step: 0.05 },
    { name: "below", label: "Only below", value: "" },
  ],
  // The static ones are enough, and a part of them.
  accepts: (topic) => topic === "/tf",
  offers: ({ topics }) => (topics.some(({ name }) => name === "/tf_static") ? ["/tf"] : []),
  make: (context) => new Frames(context),
};

const ODOMETRY: LayerKind = {
  id: "odometry",
  label: "Odometry",
  types: LAYER_TYPES.odometry,
  throttle: 30,
  isStream: true,
  isFirst: true,
  settings: [
    shape,
    size(0.5),
    color("#e5933b"),
    { name: "trail", label: "Trail", value: true },
    covariance,
  ],
  make: async (context) => new (await import("./layers/poses")).Poses(context),
};

const POSE: LayerKind = {
  id: "pose",
  label: "Pose",
  types: LAYER_TYPES.pose,
  throttle: 30,
  isEvent: true,
  isFirst: true,
  settings: [
    shape,
    size(0.6),
    color("#b04fd8"),
    { name: "trail", label: "Trail", value: false },
    covariance,
  ],
  make: async (context) => new (await import("./layers/poses")).Poses(context),
};

const POSE_ARRAY: LayerKind = {
  id: "poses",
  label: "Poses",
  types: LAYER_TYPES.poses,
  throttle: 50,
  isEvent: true,
  isFirst: true,
  settings: [shape, size(0.25), color("#b04fd8")],
  make: async (context) => new (await import("./layers/poses")).Poses(context),
};

const PATH: LayerKind = {
  id: "path",
  label: "Path",
  types: LAYER_TYPES.path,
  throttle: 50,
  isFirst: true,
  settings: [color("#2fa84f"), width, { name: "arrows", label: "Arrows", value: false }],
  make: async (context) => new (await import("./layers/lines")).Lines(context),
};

const POLYGON: LayerKind = {
  id: "polygon",
  label: "Polygon",
  types: LAYER_TYPES.polygon,
  throttle: 50,
  isFirst: true,
  settings: [color("#2fa84f"), width],
  make: async (context) => new (await import("./layers/lines")).Lines(context),
};

const GRID_CELLS: LayerKind = {
  id: "gridCells",
  label: "Grid cells",
  types: LAYER_TYPES.gridCells,
  throttle: 50,
  settings: [
    color("#e58a2f"),
    { name: "alpha", label: "Opacity", value: 0.6, min: 0, max: 1, step: 0.1 },
  ],
  make: async (context) => new (await import("./layers/lines")).GridCells(context),
};

const POINT: LayerKind = {
  id: "point",
  label: "Point",
  types: LAYER_TYPES.point,
  throttle: 30,
  isEvent: true,
  isFirst: true,
  settings: [
    color("#d8b33f"),
    { name: "size", label: "Size (m)", value: 0.15, min: 0.01, max: 5, step: 0.05 },
  ],
  make: async (context) => new (await import("./layers/readings")).Point(context),
};

const RANGE: LayerKind = {
  id: "range",
  label: "Range",
  types: LAYER_TYPES.range,
  throttle: 30,
  isStream: true,
  isFirst: true,
  settings: [color("#3e8ef7")],
  make: async (context) => new (await import("./layers/readings")).Range(context),
};

const VECTORS: LayerKind = {
  id: "arrows",
  label: "Twist or wrench",
  types: LAYER_TYPES.arrows,
  throttle: 30,
  settings: [
    color("#2fa84f"),
    { name: "turnColor", label: "Colour of turns", value: "#e58a2f" },
    { name: "scale", label: "Metres per unit", value: 1, min: 0.001, max: 100, step: 0.1 },
  ],
  make: async (context) => new (await import("./layers/readings")).Vectors(context),
};

const markers = async (context: LayerContext): Promise<Layer> =>
  new (await import("./layers/markers")).Markers(context);
const hidden: Setting = { name: "hidden", label: "Hidden namespaces", value: "" };
/** Markers that wait: each one is a change, so that none may be skipped. */
const MARKER_QUEUE = 200;

const MARKER: LayerKind = {
  id: "markers",
  label: "Markers",
  types: LAYER_TYPES.markers,
  throttle: 0,
  queue: MARKER_QUEUE,
  isFirst: true,
  settings: [hidden],
  make: markers,
};

const INTERACTIVE_MARKERS: LayerKind = {
  id: "interactiveMarkers",
  label: "Interactive markers",
  types: LAYER_TYPES.interactiveMarkers,
  throttle: 0,
  queue: MARKER_QUEUE,
  updates: (topic) => ({
    topic: topic.replace(/_full$/, ""),
    type: "visualization_msgs/InteractiveMarkerUpdate",
  }),
  isFirst: true,
  settings: [hidden],
  make: markers,
};

const DESCRIPTION = "/robot_description";

const ROBOT_MODEL: LayerKind = {
  id: "robot",
  label: "Robot model",
  types: LAYER_TYPES.robot,
  throttle: 0,
  isOwn: true,
  isFirst: true,
  isContext: true,
  settings: [
    { name: "visual", label: "Visual", value: true },
    { name: "collision", label: "Collision", value: false },
    { name: "alpha", label: "Opacity", value: 1, min: 0, max: 1, step: 0.1 },
    { name: "joints", label: "Joint states", value: "" },
    { name: "prefix", label: "Prefix of frames", value: "" },
  ],
  accepts: (topic) => topic.endsWith(DESCRIPTION),
  // The description may be a parameter of that name.
  offers: ({ topics }) => [
    ...topics
      .filter(({ type }) => type === "sensor_msgs/JointState")
      .map(({ name }) => name.slice(0, name.lastIndexOf("/")) + DESCRIPTION),
    ...(topics.some(({ name }) => name === "/tf") ? [DESCRIPTION] : []),
  ],
  make: async (context) => new (await import("./layers/robot_model")).RobotModel(context),
};

const CAMERA_INFO: LayerKind = {
  id: "camera",
  label: "Camera's view",
  types: LAYER_TYPES.camera,
  throttle: 100,
  settings: [
    color("#8a6fd1"),
    { name: "depth", label: "Length (m)", value: 1, min: 0.01, max: 100, step: 0.1 },
  ],
  make: async (context) => new (await import("./layers/camera_info")).CameraInfo(context),
};

/** In the order of the list of layers. What most scenes do not need is loaded when it is shown. */
export const LAYER_KINDS: readonly LayerKind[] = [
  OCCUPANCY_GRID,
  ROBOT_MODEL,
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
  MARKER,
  INTERACTIVE_MARKERS,
  CAMERA_INFO,
];
