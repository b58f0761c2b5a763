/** The types of the topics whose readings are shown. */
export const READING_TYPES = {
  joints: "sensor_msgs/JointState",
  attitude: "sensor_msgs/Imu",
  battery: "sensor_msgs/BatteryState",
  position: "sensor_msgs/NavSatFix",
} as const;
