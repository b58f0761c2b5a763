/** Actions over topics, as in actionlib's tutorial. */

import { answer, collect } from "../world.mjs";

const FIBONACCI = "actionlib_tutorials/FibonacciAction";

export default {
  "action sends feedback and a result": async (world) => {
    const { client, goal } = await action(world, "/quick", (server) => {
      server.on("goal", ({ order }) => {
        const sequence = [0, 1];
        while (sequence.length < order) {
          sequence.push(sequence.at(-1) + sequence.at(-2));
          server.sendFeedback({ sequence });
        }
        server.setSucceeded({ sequence });
      });
    });
    return follow(goal(client, 5));
  },

  "goal can be cancelled": async (world) => {
    const { client, goal } = await action(world, "/patient", (server) => {
      server.on("goal", () => server.sendFeedback({ sequence: [0, 1] }));
      server.on("cancel", () => server.setPreempted());
    });
    const sent = goal(client, 5);
    sent.on("feedback", () => sent.cancel());
    return follow(sent);
  },

  "all goals can be cancelled": async (world) => {
    const { client, goal } = await action(world, "/all", (server) => {
      server.on("goal", () => server.sendFeedback({ sequence: [0, 1] }));
      server.on("cancel", () => server.setPreempted());
    });
    const sent = goal(client, 5);
    sent.on("feedback", () => client.cancel());
    return follow(sent);
  },

  "newer goal replaces the older one": async (world) => {
    const { client, goal } = await action(world, "/busy", (server) => {
      server.on("goal", ({ order }) => {
        server.sendFeedback({ sequence: [order] });
        if (order === 2) server.setSucceeded({ sequence: [2] });
      });
      server.on("cancel", () => server.setPreempted());
    });
    const older = goal(client, 1);
    const fate = follow(older);
    const newer = await new Promise((resolve) =>
      older.on("feedback", () => resolve(follow(goal(client, 2)))),
    );
    return { older: await fate, newer };
  },

  "action servers are listed": async (world) => {
    const { client } = await action(world, "/listed_action", () => {});
    const servers = await answer((done, failed) => client.ros.getActionServers(done, failed));
    return servers.includes("/listed_action");
  },
};

/** A server that `serve` sets up, a client that knows it, and a way to send it goals. */
export async function action({ library, connect }, serverName, serve) {
  const options = { serverName, actionName: FIBONACCI };
  serve(new library.SimpleActionServer({ ros: await connect(), ...options }));
  const client = new library.ActionClient({ ros: await connect(), ...options });
  await new Promise((resolve) => client.statusListener.subscribe(resolve));
  const goal = (actionClient, order) => {
    const sent = new library.Goal({ actionClient, goalMessage: { order } });
    sent.feedbacks = collect();
    sent.on("feedback", sent.feedbacks.add);
    sent.send();
    return sent;
  };
  return { client, goal };
}

/** How a goal went on and ended: roslib tells the last status before the result. */
export const follow = (goal) =>
  new Promise((resolve) => {
    goal.on("result", (result) =>
      resolve({ feedback: goal.feedbacks.seen, status: goal.status.status, result }),
    );
  });
