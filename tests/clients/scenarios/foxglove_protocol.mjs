/** What `FoxgloveClient` does with Foxglove's own protocol: every operation that it has. */

import { collect } from "../world.mjs";

const INT32 = { encoding: "ros1", schemaName: "std_msgs/Int32" };

export default {
  "server introduces itself": async (world) => {
    const { info, close } = await connect(world);
    close();
    const { capabilities, supportedEncodings, metadata } = info;
    return { capabilities: capabilities.sort(), supportedEncodings, metadata };
  },

  "topic of another client is a channel": async (world) => {
    const [robot, studio] = [await connect(world), await connect(world)];
    robot.client.advertise({ topic: "/robot/number", ...INT32 });
    const channel = await studio.channel("/robot/number");
    return { ...channel, id: typeof channel.id };
  },

  "message arrives with its time": async (world) => {
    const [robot, studio] = [await connect(world), await connect(world)];
    const channel = robot.client.advertise({ topic: "/robot/speed", ...INT32 });
    const subscription = studio.client.subscribe((await studio.channel("/robot/speed")).id);
    await studio.settled();
    robot.client.sendMessage(channel, int32(-5));
    const [message] = await studio.messages.many(1);
    return {
      subscription: message.subscriptionId === subscription,
      time: message.timestamp > 1_700_000_000_000_000_000n,
      data: message.data.getInt32(0, true),
    };
  },

  "json is serialized": async (world) => {
    const [robot, studio] = [await connect(world), await connect(world)];
    const text = { topic: "/robot/text", encoding: "json", schemaName: "std_msgs/String" };
    const channel = robot.client.advertise(text);
    studio.client.subscribe((await studio.channel("/robot/text")).id);
    await studio.settled();
    robot.client.sendMessage(channel, new TextEncoder().encode('{"data": "hi"}'));
    const [{ data }] = await studio.messages.many(1);
    return Array.from(new Uint8Array(data.buffer, data.byteOffset, data.byteLength));
  },

  "nothing comes after the subscription": async (world) => {
    const [robot, studio] = [await connect(world), await connect(world)];
    const channel = robot.client.advertise({ topic: "/robot/ended", ...INT32 });
    const { id } = await studio.channel("/robot/ended");
    const subscription = studio.client.subscribe(id);
    await studio.settled();
    studio.client.unsubscribe(subscription);
    await studio.settled();
    robot.client.sendMessage(channel, int32(1));
    await robot.settled();
    await studio.settled();
    // What the clients before it have left may go at the same time.
    const removed = collect();
    studio.client.on("unadvertise", (ids) => ids.filter((each) => each === id).forEach(removed.add));
    robot.client.unadvertise(channel);
    await removed.many(1);
    return { received: studio.messages.seen.length, removed: removed.seen.length };
  },

  "service is called in both encodings": async (world) => {
    const studio = await connect(world);
    const time = await studio.call("/rosapi/get_time", "ros1", new Uint8Array(0));
    const request = new TextEncoder().encode('{"service": "/rosapi/get_time"}');
    const type = await studio.call("/rosapi/service_type", "json", request);
    const seconds = new DataView(time.data.buffer, time.data.byteOffset).getUint32(0, true);
    return {
      time: [time.encoding, time.data.byteLength, seconds > 1_700_000_000],
      type: [type.encoding, JSON.parse(new TextDecoder().decode(type.data))],
    };
  },

  "failing call says why": async (world) => {
    const studio = await connect(world);
    const { id } = await studio.service("/rosapi/service_type");
    const failed = new Promise((resolve) => studio.client.on("serviceCallFailure", resolve));
    const request = { serviceId: id, callId: 9, encoding: "ros1", data: int32(1000) };
    studio.client.sendServiceCallRequest(request);
    const { callId, message } = await failed;
    return { callId, message: typeof message };
  },

  "parameters are set and read and followed": async (world) => {
    const [studio, other] = [await connect(world), await connect(world)];
    const updates = collect();
    other.client.on("parameterValues", ({ id, parameters }) => id ?? updates.add(parameters));
    other.client.subscribeParameterUpdates(["/robot/speed_limit"]);
    await other.settled();
    const answer = studio.parameters("set");
    studio.client.setParameters(
      [
        { name: "/robot/speed_limit", value: 2, type: "float64" },
        { name: "/robot/names", value: ["a", "b"] },
        { name: "/robot/blob", value: "AP8=", type: "byte_array" },
      ],
      "set",
    );
    const set = await answer;
    await updates.many(1);
    const all = studio.parameters("get-all-params");
    studio.client.getParameters([], "get-all-params");
    const read = (await all).filter(({ name }) => name.startsWith("/robot/"));
    studio.client.setParameters([{ name: "/robot/speed_limit", value: undefined }], "delete");
    await updates.many(2);
    other.client.unsubscribeParameterUpdates(["/robot/speed_limit"]);
    await other.settled();
    studio.client.setParameters([{ name: "/robot/speed_limit", value: 3 }], "again");
    await studio.settled();
    await other.settled();
    return { set, read, updates: updates.seen };
  },

  "connection graph is followed": async (world) => {
    const [robot, studio] = [await connect(world, "/graph_robot"), await connect(world)];
    const mine = collect();
    studio.client.on("connectionGraphUpdate", ({ publishedTopics, removedTopics }) => {
      const [topic] = publishedTopics.filter(({ name }) => name === "/graph/number");
      if (topic) mine.add(topic);
      if (removedTopics.includes("/graph/number")) mine.add("removed");
    });
    studio.client.subscribeConnectionGraph();
    const channel = robot.client.advertise({ topic: "/graph/number", ...INT32 });
    await mine.many(1);
    robot.client.unadvertise(channel);
    const seen = await mine.many(2);
    studio.client.unsubscribeConnectionGraph();
    return seen;
  },

  "unknown channel is an error": async (world) => {
    const studio = await connect(world);
    const status = new Promise((resolve) => studio.client.on("status", resolve));
    studio.client.subscribe(99_999);
    return await status;
  },

  "unknown asset is an error": async (world) => {
    const studio = await connect(world);
    const response = new Promise((resolve) => studio.client.on("fetchAssetResponse", resolve));
    studio.client.fetchAsset("package://nothing/mesh.stl", 7);
    const { requestId, status, error } = await response;
    return { requestId, status, error: typeof error };
  },
};

/** A client that has been told what the hub can do. */
export async function connect({ library: FoxgloveClient, url }, node = "") {
  const address = node ? `${url}/?node=${node}` : url;
  const client = new FoxgloveClient({
    ws: new WebSocket(address, ["foxglove.sdk.v1", FoxgloveClient.SUPPORTED_SUBPROTOCOL]),
  });
  const info = new Promise((resolve) => client.on("serverInfo", resolve));
  const [channels, services] = [offered(client, "advertise"), offered(client, "advertiseServices")];
  const messages = collect();
  client.on("message", messages.add);
  let settled = 0;

  /** Resolves with the values of the answer that has an id. */
  function parameters(id) {
    return new Promise((resolve) =>
      client.on("parameterValues", (answer) => answer.id === id && resolve(answer.parameters)),
    );
  }

  return {
    client,
    info: await info,
    messages,
    parameters,
    channel: (topic) => channels((channel) => channel.topic === topic),
    service: (name) => services((service) => service.name === name),
    close: () => client.close(),

    /** Calls a service; resolves with its response. */
    async call(name, encoding, data) {
      const { id } = await services((service) => service.name === name);
      const response = new Promise((resolve, reject) => {
        client.on("serviceCallResponse", (each) => each.serviceId === id && resolve(each));
        client.on("serviceCallFailure", ({ message }) => reject(new Error(message)));
      });
      client.sendServiceCallRequest({ serviceId: id, callId: 1, encoding, data });
      return response;
    },

    /** Resolves when the hub has done all that this client asked for before. */
    settled() {
      const id = `settled ${++settled}`;
      const answer = parameters(id);
      client.getParameters(["/nothing"], id);
      return answer;
    },
  };
}

/** Resolves with the first of what the hub offers that fits, once there is one. */
function offered(client, event) {
  const known = [];
  let look = () => {};
  client.on(event, (entries) => {
    known.push(...entries);
    look();
  });
  return (fits) =>
    new Promise((resolve) => {
      const previous = look;
      look = () => {
        previous();
        const found = known.find(fits);
        if (found) resolve(found);
      };
      look();
    });
}

export function int32(value) {
  const data = new DataView(new ArrayBuffer(4));
  data.setInt32(0, value, true);
  return new Uint8Array(data.buffer);
}
