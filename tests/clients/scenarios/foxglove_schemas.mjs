/** What Foxglove and Lichtblick make of the schemas that the hub sends them. */

import { readdirSync } from "node:fs";

import { parse } from "@foxglove/rosmsg";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg-serialization";

import { connect } from "./foxglove_protocol.mjs";

const DEFINITIONS = new URL("../../../fibws/interfaces/definitions/", import.meta.url);

export default {
  "every type is parsed and its messages are decoded": async (world) => {
    const [robot, studio] = [await connect(world), await connect(world)];
    const types = everyType();
    const empty = new TextEncoder().encode("{}");
    const channels = types.map((schemaName) =>
      robot.client.advertise({ topic: `/every/${schemaName}`, encoding: "json", schemaName }),
    );
    const readers = new Map();
    for (const type of types) {
      const { id, schema } = await studio.channel(`/every/${type}`);
      readers.set(studio.client.subscribe(id), new MessageReader(parse(schema)));
    }
    await studio.settled();
    channels.forEach((channel) => robot.client.sendMessage(channel, empty));
    const messages = await studio.messages.many(types.length);
    const read = messages.map(({ subscriptionId, data }) =>
      readers.get(subscriptionId).readMessage(data),
    );
    return { types: types.length, read: read.length };
  },

  "publish panel reaches another client": async (world) => {
    const [studio, robot] = [await connect(world), await connect(world)];
    const schema = parse((await twist(robot)).schema);
    const channel = studio.client.advertise({
      topic: "/panel/cmd_vel",
      encoding: "ros1",
      schemaName: "geometry_msgs/Twist",
      schema: (await twist(robot)).schema,
      schemaEncoding: "ros1msg",
    });
    robot.client.subscribe((await robot.channel("/panel/cmd_vel")).id);
    await robot.settled();
    const none = { x: 0, y: 0, z: 0 };
    const message = { linear: { ...none, x: 0.5 }, angular: { ...none, z: -1 } };
    studio.client.sendMessage(channel, new MessageWriter(schema).writeMessage(message));
    const [{ data }] = await robot.messages.many(1);
    return new MessageReader(schema).readMessage(data);
  },

  "service panel reads every schema": async (world) => {
    const studio = await connect(world);
    const { request, response } = await studio.service("/rosapi/message_details");
    const data = new MessageWriter(parse(request.schema)).writeMessage({ type: "std_msgs/Bool" });
    const answer = await studio.call("/rosapi/message_details", request.encoding, data);
    const { typedefs } = new MessageReader(parse(response.schema)).readMessage(answer.data);
    return typedefs.map(({ type, fieldnames }) => ({ type, fieldnames }));
  },
};

/** A channel of geometry_msgs/Twist, whose schema is the text that the application knows. */
async function twist(robot) {
  const type = { encoding: "json", schemaName: "geometry_msgs/Twist" };
  robot.client.advertise({ topic: "/panel/other", ...type });
  return robot.channel("/panel/other");
}

/** Types by the names that ROS 1 gives them, of all the definitions in the package. */
function everyType() {
  return readdirSync(DEFINITIONS, { recursive: true })
    .filter((path) => path.endsWith(".msg"))
    .map((path) => path.replace("/msg/", "/").replace(".msg", ""));
}
