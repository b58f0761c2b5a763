/** Messages in the compressions that roslib asks for. */

import { collect } from "../world.mjs";

export default {
  "laser scan arrives by cbor": (world) =>
    heard(world, "cbor", "/cbor/scan", "sensor_msgs/LaserScan", {
      header: { stamp: { secs: 1, nsecs: 2 }, frame_id: "laser" },
      angle_min: -1.5,
      ranges: [0.5, 1.25, -3],
      intensities: [],
    }),

  "pose with covariance arrives by cbor": (world) =>
    heard(world, "cbor", "/cbor/pose", "geometry_msgs/PoseWithCovariance", {
      pose: { position: { x: 1, y: 2, z: 3 }, orientation: { w: 1 } },
      covariance: Array.from({ length: 36 }, (_, index) => index / 4),
    }),

  "image arrives by cbor": (world) =>
    heard(world, "cbor", "/cbor/image", "sensor_msgs/Image", {
      header: { stamp: { secs: 1, nsecs: 2 }, frame_id: "camera" },
      height: 1,
      width: 2,
      encoding: "rgb8",
      step: 6,
      data: [255, 0, 1, 2, 3, 254],
    }),

  "arrays of integers arrive by cbor": async (world) => {
    const arrays = { Int8: [-1, 127], UInt16: [65535], Int16: [-2], UInt32: [7], Int32: [-8, 9] };
    const messages = Object.entries(arrays).map(async ([name, data]) => {
      const type = `std_msgs/${name}MultiArray`;
      return [name, (await heard(world, "cbor", `/cbor/${name}`, type, { data })).data];
    });
    return Object.fromEntries(await Promise.all(messages));
  },

  "nan arrives by cbor": (world) =>
    heard(world, "cbor", "/cbor/temperature", "std_msgs/Float64", { data: NaN }).then(
      ({ data }) => String(data),
    ),

  "message arrives by cbor raw": async (world) => {
    const message = await heard(world, "cbor-raw", "/raw/text", "std_msgs/String", { data: "héllo" });
    const { secs, nsecs } = message;
    return { bytes: message.bytes, age: Date.now() / 1000 - (secs + nsecs / 1e9) };
  },
};

export const heard = async ({ library, connect }, compression, name, messageType, message) => {
  const topic = { ros: await connect(), name, messageType };
  const messages = collect();
  new library.Topic({ ...topic, compression }).subscribe(messages.add);
  new library.Topic(topic).publish(message);
  return (await messages.many(1))[0];
};
