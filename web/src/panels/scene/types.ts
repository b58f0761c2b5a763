/** The types of the topics that the scene draws, by its layers. */
export const LAYER_TYPES = {
  map: ["nav_msgs/OccupancyGrid"],
  laserScan: ["sensor_msgs/LaserScan", "sensor_msgs/MultiEchoLaserScan"],
  pointCloud: ["sensor_msgs/PointCloud2", "sensor_msgs/PointCloud"],
  frames: ["tf2_msgs/TFMessage", "tf/tfMessage"],
  odometry: ["nav_msgs/Odometry"],
  pose: ["geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped"],
  poses: ["geometry_msgs/PoseArray"],
  path: ["nav_msgs/Path"],
  polygon: ["geometry_msgs/PolygonStamped"],
  gridCells: ["nav_msgs/GridCells"],
  point: ["geometry_msgs/PointStamped"],
  range: ["sensor_msgs/Range"],
  arrows: ["geometry_msgs/TwistStamped", "geometry_msgs/WrenchStamped"],
  markers: ["visualization_msgs/Marker", "visualization_msgs/MarkerArray"],
  interactiveMarkers: ["visualization_msgs/InteractiveMarkerInit"],
  robot: ["std_msgs/String"],
  camera: ["sensor_msgs/CameraInfo"],
} as const;

export type LayerId = keyof typeof LAYER_TYPES;

/** Those whose own page has no scene: a text, which may describe a robot, and commands. */
const NOT_ALONE: readonly string[] = [...LAYER_TYPES.robot, "geometry_msgs/TwistStamped"];

/** The types whose page has a scene: those of its layers, and the joints of its robots. */
export const SCENE_TYPES: readonly string[] = [
  ...Object.values(LAYER_TYPES)
    .flat()
    .filter((type) => !NOT_ALONE.includes(type)),
  "sensor_msgs/JointState",
];
