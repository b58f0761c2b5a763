/** Topics, as the README of roslib uses them. */

import { collect } from "../world.mjs";

export default {
  "message reaches another client": async ({ library, connect, settled }) => {
    const [talker, listener] = [await connect(), await connect()];
    const chatter = { name: "/chatter", messageType: "std_msgs/String" };
    const received = collect();
    new library.Topic({ ros: listener, ...chatter }).subscribe(received.add);
    await settled(listener);
    const topic = new library.Topic({ ros: talker, ...chatter });
    topic.publish({ data: "hello" });
    topic.publish({ data: "wörld 🌍" });
    return received.many(2);
  },

  "client receives its own messages": async ({ library, connect }) => {
    const topic = new library.Topic({
      ros: await connect(),
      name: "/monologue",
      messageType: "std_msgs/Int32",
    });
    const received = collect();
    topic.subscribe(received.add);
    topic.publish({ data: 8 });
    return received.many(1);
  },

  "message of many fields arrives as it was sent": async ({ library, connect }) => {
    const topic = new library.Topic({
      ros: await connect(),
      name: "/imu",
      messageType: "sensor_msgs/Imu",
    });
    const received = collect();
    topic.subscribe(received.add);
    topic.publish({
      header: { seq: 0, stamp: { secs: 12, nsecs: 34 }, frame_id: "base_link" },
      orientation: { x: 0, y: 0, z: 0, w: 1 },
      orientation_covariance: [1.5, 0, 0, 0, NaN, 0, 0, 0, -2],
      linear_acceleration: { z: -9.81 },
    });
    const [message] = await received.many(1);
    return message;
  },

  "late subscriber receives the latched message once": async ({ library, connect, settled }) => {
    const [talker, listener] = [await connect(), await connect()];
    const map = { name: "/map_name", messageType: "std_msgs/String" };
    const topic = new library.Topic({ ros: talker, ...map, latch: true });
    topic.advertise();
    topic.publish({ data: "attic" });
    topic.publish({ data: "cellar" });
    await settled(talker);
    const received = collect();
    new library.Topic({ ros: listener, ...map }).subscribe(received.add);
    await settled(listener);
    return received.many(1);
  },

  "throttled subscriber receives the first message and then the newest": async (world) => {
    const { received } = await throttled(world, "/newest", { queue_length: 1 });
    return received.many(2);
  },

  "queue of a throttled subscriber is sent after the first message": async (world) => {
    const { received } = await throttled(world, "/drained", { queue_length: 3 });
    return received.many(4);
  },

  "throttled subscriber without a queue misses early messages": async (world) => {
    const { talker, received } = await throttled(world, "/missed", {});
    while (received.seen.length < 2) {
      talker.publish({ data: 10 });
      await world.settled(talker.ros);
    }
    return received.many(2);
  },

  "two subscribers of one client receive each message once": async ({ library, connect, settled }) => {
    const number = { ros: await connect(), name: "/shared", messageType: "std_msgs/Int32" };
    const listeners = [collect(), collect()];
    listeners.forEach(({ add }) => new library.Topic(number).subscribe(({ data }) => add(data)));
    const talker = new library.Topic(number);
    [1, 2].forEach((data) => talker.publish({ data }));
    await settled(number.ros);
    return listeners.map(({ seen }) => seen);
  },

  "topic may be spelled without its slash and its type as in ROS 2": async (world) => {
    const { library, connect, settled } = world;
    const [talker, listener] = [await connect(), await connect()];
    const received = collect();
    new library.Topic({
      ros: listener,
      name: "spelled/chatter",
      messageType: "std_msgs/msg/String",
    }).subscribe(received.add);
    await settled(listener);
    new library.Topic({
      ros: talker,
      name: "/spelled/chatter",
      messageType: "std_msgs/String",
    }).publish({ data: "hello" });
    return received.many(1);
  },

  "message of megabytes arrives": async ({ library, connect }) => {
    const topic = new library.Topic({
      ros: await connect(),
      name: "/essay",
      messageType: "std_msgs/String",
    });
    const sent = "0123456789".repeat(300_000);
    const received = collect();
    topic.subscribe(received.add);
    topic.publish({ data: sent });
    const [{ data }] = await received.many(1);
    return data === sent;
  },

  "no message arrives after unsubscribing": async ({ library, connect, settled }) => {
    const ros = await connect();
    const number = { ros, name: "/number", messageType: "std_msgs/Int32" };
    const talker = new library.Topic(number);
    const listener = new library.Topic(number);
    const received = collect();
    listener.subscribe(received.add);
    talker.publish({ data: 1 });
    await received.many(1);
    listener.unsubscribe();
    talker.publish({ data: 2 });
    await settled(ros);
    listener.subscribe(received.add);
    talker.publish({ data: 3 });
    return received.many(2);
  },

  "topic disappears with its last publisher": async ({ library, connect, settled }) => {
    const ros = await connect();
    const topic = new library.Topic({ ros, name: "/gone", messageType: "std_msgs/Int32" });
    const there = () =>
      new Promise((resolve) => ros.getTopics(({ topics }) => resolve(topics.includes("/gone"))));
    topic.advertise();
    const before = await there();
    topic.unadvertise();
    await settled(ros);
    return { before, after: await there() };
  },
};

/**
 * A listener that is sent one message in so many ms, and what has published ten of them to it.
 *
 * All ten must reach the hub before it may send a second one. If one has come by then, they were
 * too slow for that, and are sent again at a lower rate.
 */
async function throttled(world, name, options, rate = 300) {
  const topic = `${name}/${rate}`;
  const number = { ros: await world.connect(), name: topic, messageType: "std_msgs/Int32" };
  const received = collect();
  const listener = new world.library.Topic({ ...number, throttle_rate: rate, ...options });
  listener.subscribe(({ data }) => received.add(data));
  const talker = new world.library.Topic(number);
  for (let data = 0; data < 10; data++) talker.publish({ data });
  await world.settled(number.ros);
  if (received.seen.length > 1 && rate < 10_000) return throttled(world, name, options, 2 * rate);
  return { talker, received };
}
