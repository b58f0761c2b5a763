/** Messages in fragments, which roslib puts together from version 2 on. */

import { collect } from "../world.mjs";

export default {
  "message arrives in fragments on request": async ({ library, connect }) => {
    const ros = await connect();
    const sent = "äöü".repeat(500);
    const heard = collect();
    ros.on("/long", ({ msg }) => heard.add(msg));
    ros.callOnConnection({
      op: "subscribe",
      topic: "/long",
      type: "std_msgs/String",
      fragment_size: 100,
    });
    const fragments = collect();
    ros.transport.socket.addEventListener("message", ({ data }) => fragments.add(JSON.parse(data)));
    new library.Topic({ ros, name: "/long", messageType: "std_msgs/String" }).publish({ data: sent });
    const [message] = await heard.many(1);
    const ops = new Set(fragments.seen.map(({ op }) => op));
    return { equal: message.data === sent, ops: [...ops], many: fragments.seen.length > 10 };
  },
};
