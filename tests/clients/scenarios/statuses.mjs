/** What the hub says when an operation was wrong. */

import { collect } from "../world.mjs";

export default {
  "invalid message is refused with the reason": async (world) =>
    statuses(world, (topic) => topic.publish({ data: "eight" })),

  "topic keeps its type": async (world) =>
    statuses(world, ({ ros }) => {
      const messageType = "std_msgs/String";
      new world.library.Topic({ ros, name: "/strict", messageType }).advertise();
    }),
};

/** The statuses that come of doing something with a topic of type Int32. */
async function statuses({ library, connect }, act) {
  const seen = collect();
  const ros = await connect({ status: seen.add });
  const topic = new library.Topic({ ros, name: "/strict", messageType: "std_msgs/Int32" });
  topic.advertise();
  act(topic);
  return seen.many(1);
}
