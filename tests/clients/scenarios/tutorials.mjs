/** The programs of this package that serve what ROS's tutorials do. */

import { call, collect } from "../world.mjs";

export default {
  "tutorial service adds two ints": async ({ library, connect }) => {
    const serviceType = "rospy_tutorials/AddTwoInts";
    const name = "/add_two_ints";
    return call(new library.Service({ ros: await connect(), name, serviceType }), { a: 1, b: 2 });
  },

  "tutorial action returns the sequence and can be cancelled": async (world) => {
    const { library, connect } = world;
    const actionClient = new library.ActionClient({
      ros: await connect(),
      serverName: "/fibonacci",
      actionName: "actionlib_tutorials/FibonacciAction",
    });
    await new Promise((resolve) => actionClient.statusListener.subscribe(resolve));
    const pursue = async (order, onFeedback) => {
      const goal = new library.Goal({ actionClient, goalMessage: { order } });
      const results = collect();
      goal.on("feedback", () => onFeedback(goal));
      goal.on("result", results.add);
      goal.send();
      const [{ sequence }] = await results.many(1);
      return { sequence, status: goal.status.status };
    };
    const done = await pursue(5, () => {});
    const cancelled = await pursue(40, (goal) => goal.cancel());
    return { done, cancelled: cancelled.status };
  },
};
