/** The action of ROS 2's tutorial, which roslib asks for from version 2 on. */

import { collect } from "../world.mjs";

export default {
  "tutorial action returns the sequence by operation": async ({ library, connect }) => {
    const client = new library.Action({
      ros: await connect(),
      name: "/fibonacci",
      actionType: "example_interfaces/action/Fibonacci",
    });
    const feedback = collect();
    const result = await new Promise((resolve, reject) =>
      client.sendGoal({ order: 5 }, resolve, feedback.add, reject),
    );
    return { ...result, feedback: feedback.seen.map(({ sequence }) => sequence.length) };
  },
};
