/** What Foxglove and Lichtblick do with a rosbridge, from connecting on. */

import { readdirSync } from "node:fs";

import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg-serialization";

import { answer, call, collect } from "../world.mjs";

const DEFINITIONS = new URL("../../../fibws/interfaces/definitions/", import.meta.url);

export default {
  "ros version is detected by the topics": async ({ connect }) => {
    const { types } = await topicsAndRawTypes(await connect());
    if (types.includes("rcl_interfaces/msg/Log")) return 2;
    return types.includes("rosgraph_msgs/Log") ? 1 : "unknown";
  },

  "every type is parsed and its messages are decoded": async ({ library, connect, settled }) => {
    const [robot, foxglove] = [await connect(), await connect()];
    const topics = everyType().map(
      (messageType) => new library.Topic({ ros: robot, name: `/every/${messageType}`, messageType }),
    );
    topics.forEach((topic) => topic.advertise());
    await settled(robot);
    const readers = await readersByTopic(foxglove);
    const read = topics.map(({ name }) => first(library, foxglove, name, readers));
    await settled(foxglove);
    topics.forEach((topic) => topic.publish({}));
    const messages = await Promise.all(read);
    return { types: topics.length, read: messages.length };
  },

  "unknown type does not affect others": async (world) => {
    const ros = await world.connect();
    const thing = { ros, name: "/foxglove/thing", messageType: "my_robot/Thing" };
    new world.library.Topic(thing).advertise();
    await world.settled(ros);
    return received(world, "/foxglove/known", "std_msgs/Bool", { data: true });
  },

  "number is decoded": (world) =>
    received(world, "/foxglove/number", "std_msgs/Int32", { data: -2147483648 }),

  "pose with covariance is decoded": (world) =>
    received(world, "/foxglove/pose", "geometry_msgs/PoseWithCovarianceStamped", {
      header: { stamp: { secs: 5, nsecs: 6 }, frame_id: "map" },
      pose: {
        pose: { position: { x: 1.5, y: -2, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
        covariance: Array.from({ length: 36 }, (_, index) => index / 8),
      },
    }),

  "image is decoded": (world) =>
    received(world, "/foxglove/image", "sensor_msgs/Image", {
      header: { stamp: { secs: 5, nsecs: 6 }, frame_id: "camera" },
      height: 1,
      width: 2,
      encoding: "rgb8",
      is_bigendian: 0,
      step: 6,
      data: "/wABAgP+",
    }),

  "points are decoded": (world) =>
    received(world, "/foxglove/points", "sensor_msgs/PointCloud2", {
      header: { stamp: { secs: 5, nsecs: 6 }, frame_id: "lidar" },
      height: 1,
      width: 1,
      fields: [{ name: "x", offset: 0, datatype: 7, count: 1 }],
      point_step: 4,
      row_step: 4,
      data: [0, 0, 128, 63],
      is_dense: true,
    }),

  "graph is drawn from every node": async ({ library, connect, settled }) => {
    const robot = await connect({ node: "/robot" });
    const type = { messageType: "std_msgs/Int32" };
    new library.Topic({ ros: robot, name: "/robot/number", ...type }).advertise();
    new library.Topic({ ros: robot, name: "/robot/command", ...type }).subscribe(() => {});
    await settled(robot);
    const foxglove = await connect();
    const nodes = await answer((done, failed) => foxglove.getNodes(done, failed));
    const details = nodes.map(async (node) => {
      const lists = new Promise((resolve, reject) =>
        foxglove.getNodeDetails(node, (...given) => resolve(given), reject),
      );
      const [subscriptions, publications, services] = await lists;
      return [node, { subscriptions, publications, services }];
    });
    const graph = Object.fromEntries(await Promise.all(details));
    return { robot: graph["/robot"], log: graph["/rosout"].subscriptions };
  },

  "publish panel reaches the robot": async ({ library, connect, settled }) => {
    const [robot, foxglove] = [await connect(), await connect()];
    const velocity = { name: "/cmd_vel", messageType: "geometry_msgs/Twist" };
    const received = collect();
    new library.Topic({ ros: robot, ...velocity }).subscribe(received.add);
    await settled(robot);
    const publisher = new library.Topic({ ros: foxglove, ...velocity, queue_size: 0 });
    publisher.advertise();
    publisher.publish({ linear: { x: 0.5, y: 0, z: 0 }, angular: { x: 0, y: 0, z: -1 } });
    return (await received.many(1))[0];
  },

  "service panel calls a service by its type": async ({ library, connect }) => {
    const [robot, foxglove] = [await connect(), await connect()];
    const name = "/robot/switch";
    const switched = new library.Service({ ros: robot, name, serviceType: "std_srvs/SetBool" });
    switched.advertise(({ data }, response) => {
      Object.assign(response, { success: data, message: data ? "on" : "off" });
      return true;
    });
    await answer((done, failed) => robot.getNodes(done, failed));
    const serviceType = await answer((done, failed) => foxglove.getServiceType(name, done, failed));
    return call(new library.Service({ ros: foxglove, name, serviceType }), { data: true });
  },

  "new topic is found by the next poll": async ({ library, connect, settled }) => {
    const [robot, foxglove] = [await connect(), await connect()];
    const name = "/foxglove/new";
    const before = await topicsAndRawTypes(foxglove);
    new library.Topic({ ros: robot, name, messageType: "std_msgs/String" }).advertise();
    await settled(robot);
    const after = await topicsAndRawTypes(foxglove);
    return { before: before.topics.includes(name), after: after.topics.includes(name) };
  },
};

/** Types by the names that ROS 1 gives them, of all the definitions in the package. */
function everyType() {
  return readdirSync(DEFINITIONS, { recursive: true })
    .filter((path) => path.endsWith(".msg"))
    .map((path) => path.replace("/msg/", "/").replace(".msg", ""));
}

const topicsAndRawTypes = (ros) =>
  answer((done, failed) => ros.getTopicsAndRawTypes(done, failed));

/** A reader of each topic's messages: one text that cannot be parsed leaves Foxglove with none. */
async function readersByTopic(foxglove) {
  const { topics, typedefs_full_text } = await topicsAndRawTypes(foxglove);
  return new Map(
    topics.map((topic, index) => {
      return [topic, new MessageReader(parse(typedefs_full_text[index]))];
    }),
  );
}

/** The next message on a topic, subscribed to as Foxglove does: raw, and without a type. */
function first(library, ros, name, readers) {
  const topic = new library.Topic({ ros, name, compression: "cbor-raw" });
  return new Promise((resolve, reject) => {
    topic.subscribe(({ bytes }) => {
      try {
        resolve(readers.get(name).readMessage(bytes));
      } catch (error) {
        reject(new Error(`${name}: ${error.message}`));
      }
    });
  });
}

/** What Foxglove makes of a message that a robot sends. */
async function received({ library, connect, settled }, name, messageType, message) {
  const [robot, foxglove] = [await connect(), await connect()];
  const topic = new library.Topic({ ros: robot, name, messageType });
  topic.advertise();
  await settled(robot);
  const read = first(library, foxglove, name, await readersByTopic(foxglove));
  await settled(foxglove);
  topic.publish(message);
  return read;
}
