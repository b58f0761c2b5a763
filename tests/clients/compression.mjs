/** Exchanges long texts with a hub by the client `ws`: node compression.mjs URL BYTES... */

import WebSocket from "ws";

const [url, ...sizes] = process.argv.slice(2);
const websocket = new WebSocket(url);
const send = (op, fields) => websocket.send(JSON.stringify({ op, topic: "/t", ...fields }));
const received = [];

websocket.on("open", () => {
  const type = "std_msgs/String";
  send("subscribe", { type, queue_length: 100 });
  send("advertise", { type });
  for (const size of sizes) send("publish", { msg: { data: "x".repeat(Number(size)) } });
});
websocket.on("message", (data) => {
  const { msg } = JSON.parse(String(data));
  received.push(msg.data.length);
  if (received.length === sizes.length) websocket.close();
});
websocket.on("close", (code, reason) => {
  const { extensions } = websocket;
  console.log(JSON.stringify({ extensions, received, code, reason: String(reason) }));
});
