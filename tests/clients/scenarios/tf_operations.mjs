/** Transforms by way of tf2_web_republisher's action by operation, which roslib has from 2 on. */

import { collect } from "../world.mjs";
import { follow, LISTENING, move } from "./tf.mjs";

export default {
  "transforms arrive by operation": (world) =>
    follow(world, "by_operation", { client: "ROS2TFClient" }),

  "another frame starts another goal by operation": async ({ library, connect }) => {
    const ros = await connect();
    const topic = new library.Topic({ ros, name: "/tf", messageType: "tf2_msgs/TFMessage" });
    const tf = new library.ROS2TFClient({ ros, ...LISTENING });
    const ends = collect();
    for (const frame of ["first", "second"]) {
      const heard = collect();
      tf.subscribe(frame, heard.add);
      move(topic, frame, { x: 0, y: 0, z: 0 }, { x: 0, y: 0, z: 0, w: 1 });
      await heard.many(1);
      ros.on(tf.goal_id, ({ op, status }) => op === "action_result" && ends.add(status));
    }
    tf.dispose();
    return ends.many(2);
  },
};
