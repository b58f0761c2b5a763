/** What roslib in JavaScript has of actionlib, and roslibpy has not. */

import { collect } from "../world.mjs";
import { action, follow } from "./actionlib.mjs";

export default {
  "action can abort": async (world) => {
    const { client, goal } = await action(world, "/aborting", (server) => {
      server.on("goal", () => server.setAborted({ sequence: [0] }));
    });
    return follow(goal(client, 5));
  },

  "goals of others can be followed": async (world) => {
    const { library, connect, settled } = world;
    const ros = await connect();
    const listener = new library.ActionListener({
      ros,
      serverName: "/followed",
      actionName: "actionlib_tutorials/FibonacciAction",
    });
    const received = collect();
    listener.on("goal", ({ goal }) => received.add({ goal }));
    listener.on("feedback", (feedback) => received.add({ feedback }));
    listener.on("result", (result) => received.add({ result }));
    await settled(ros);
    const { client, goal } = await action(world, "/followed", (server) => {
      server.on("goal", ({ order }) => {
        server.sendFeedback({ sequence: [0] });
        server.setSucceeded({ sequence: [order] });
      });
    });
    goal(client, 7);
    return received.many(3);
  },
};
