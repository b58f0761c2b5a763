/** What roslib asks of the hub about the graph. */

import { answer } from "../world.mjs";

const ADD = "rospy_tutorials/AddTwoInts";

export default {
  "topics and their types are listed": async (world) => {
    const ros = await graph(world, "/listed");
    const { topics, types } = await answer((done, failed) => ros.getTopics(done, failed));
    return {
      number: types[topics.indexOf("/listed/number")],
      text: types[topics.indexOf("/listed/text")],
      log: types[topics.indexOf("/rosout")],
    };
  },

  "topics can be found by type and types by topic": async (world) => {
    const ros = await graph(world, "/found");
    const found = await answer((done, failed) =>
      ros.getTopicsForType("std_msgs/Int16", done, failed),
    );
    return {
      topics: found.filter((topic) => topic.startsWith("/found")),
      type: await answer((done, failed) => ros.getTopicType("/found/number", done, failed)),
      none: await answer((done, failed) => ros.getTopicType("/found/nowhere", done, failed)),
    };
  },

  "services can be listed and found by type and types by service": async (world) => {
    const ros = await graph(world, "/served");
    const services = await answer((done, failed) => ros.getServices(done, failed));
    const found = await answer((done, failed) =>
      ros.getServicesForType("std_srvs/SetBool", done, failed),
    );
    return {
      listed: services.filter((service) => service.startsWith("/served")),
      ours: services.includes("/rosapi/topics"),
      found: found.filter((service) => service.startsWith("/served")),
      type: await answer((done, failed) => ros.getServiceType("/served/switch", done, failed)),
      none: await answer((done, failed) => ros.getServiceType("/served/nowhere", done, failed)),
    };
  },

  "nodes are listed with their details": async (world) => {
    const ros = await graph(world, "/looked_into");
    const nodes = await answer((done, failed) => ros.getNodes(done, failed));
    const details = await new Promise((resolve, reject) => {
      // roslib 2 gives one object here, the older ones three lists.
      ros.getNodeDetails("/looked_into", (...given) => resolve(given), reject);
    });
    const [subscribing, publishing, services] =
      details.length === 3
        ? details
        : [details[0].subscribing, details[0].publishing, details[0].services];
    return {
      nodes: ["/looked_into", "/rosapi", "/rosout"].map((node) => nodes.includes(node)),
      subscribing,
      publishing,
      services,
    };
  },

  "message type is described field by field": async ({ connect }) => {
    const ros = await connect();
    const details = (type) => answer((done, failed) => ros.getMessageDetails(type, done, failed));
    const [[fix], pose] = [
      await details("sensor_msgs/NavSatFix"),
      await details("geometry_msgs/PoseStamped"),
    ];
    return { fix, pose: pose.map(({ type }) => type) };
  },

  "service type is described field by field": async ({ connect }) => {
    const ros = await connect();
    const details = async (method) =>
      (await answer((done, failed) => ros[method](ADD, done, failed))).typedefs;
    return {
      request: await details("getServiceRequestDetails"),
      response: await details("getServiceResponseDetails"),
    };
  },

  "all definitions are returned at once": async (world) => {
    const ros = await graph(world, "/defined");
    const { topics, types, typedefs_full_text } = await answer((done, failed) =>
      ros.getTopicsAndRawTypes(done, failed),
    );
    const text = (topic) => typedefs_full_text[topics.indexOf(topic)];
    return {
      type: types[topics.indexOf("/defined/number")],
      number: text("/defined/number").trim(),
      log: text("/rosout").includes(`${"=".repeat(80)}\nMSG: std_msgs/Header\n`),
    };
  },
};

/** A client by that name which publishes, subscribes and serves below it. */
async function graph({ library, connect, settled }, name) {
  const ros = await connect({ node: name });
  const topic = (leaf, messageType) =>
    new library.Topic({ ros, name: `${name}/${leaf}`, messageType });
  topic("number", "std_msgs/Int16").advertise();
  topic("text", "std_msgs/String").subscribe(() => {});
  const serviceType = "std_srvs/SetBool";
  await new library.Service({ ros, name: `${name}/switch`, serviceType }).advertise(() => true);
  await settled(ros);
  return ros;
}
