/** A peer of the matrix with @foxglove/ros1: node foxglove_peer.mjs NAME PEERS MESSAGES.
 *
 * The library has topics and parameters, but no services.
 */

import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";

import ros1 from "@foxglove/ros1";
import nodejs from "@foxglove/ros1/nodejs";
import { parse } from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg-serialization";
import { HttpServerNodejs } from "@foxglove/xmlrpc/nodejs";

const { MessageReader, MessageWriter } = serialization;
const KINDS = ["ints", "floats", "image"];
const [name, peers, path] = process.argv.slice(2);
const messages = JSON.parse(readFileSync(path, "utf8"));
const definition = (kind) => parse(messages[kind].definition);

function saw(what, of, value) {
  console.log(JSON.stringify({ saw: what, of, value }));
}

function message(kind) {
  return new MessageReader(definition(kind)).readMessage(Buffer.from(messages[kind].bytes, "hex"));
}

function hear(node, what, peer, kind) {
  const topic = `/${peer}/${what}/${kind}`;
  const subscription = node.subscribe({ topic, dataType: messages[kind].type });
  subscription.once("message", (found) => {
    const bytes = new MessageWriter(definition(kind)).writeMessage(found);
    saw(`${what} ${kind}`, peer, Buffer.from(bytes).toString("hex"));
  });
}

const node = new ros1.RosNode({
  name: `/${name}`,
  hostname: "127.0.0.1",
  pid: process.pid,
  rosMasterUri: process.env.ROS_MASTER_URI,
  httpServer: new HttpServerNodejs(),
  tcpSocketCreate: nodejs.TcpSocketNode.Create,
  tcpServer: await nodejs.TcpServerNode.Listen({ host: "127.0.0.1" }),
});
await node.start();
for (const kind of KINDS) {
  const options = {
    dataType: messages[kind].type,
    messageDefinition: definition(kind),
    messageDefinitionText: messages[kind].definition,
    md5sum: messages[kind].md5sum,
  };
  await node.advertise({ topic: `/${name}/latched/${kind}`, latching: true, ...options });
  await node.publish(`/${name}/latched/${kind}`, message(kind));
  await node.advertise({ topic: `/${name}/plain/${kind}`, ...options });
}
await node.setParameter(`/parameters/${name}`, messages.parameters);
console.log("ready");
createInterface({ input: process.stdin }).once("line", async () => {
  for (const peer of peers.split(",")) {
    for (const kind of KINDS) {
      hear(node, "latched", peer, kind);
      hear(node, "plain", peer, kind);
    }
    saw("parameters", peer, await node.subscribeParam(`/parameters/${peer}`));
  }
  setInterval(() => {
    for (const kind of KINDS) node.publish(`/${name}/plain/${kind}`, message(kind));
  }, 100);
});
