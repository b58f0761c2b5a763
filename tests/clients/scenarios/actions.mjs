/** Actions by operation, as ROS 2 has them and roslib from version 2 on. */

import { collect, refusal } from "../world.mjs";

const FIBONACCI = "example_interfaces/action/Fibonacci";

export default {
  "action by operation sends feedback and a result": async (world) => {
    const { server, client } = await action(world, "/operations/quick", ({ order }, id) => {
      const sequence = [0, 1];
      while (sequence.length <= order) {
        sequence.push(sequence.at(-1) + sequence.at(-2));
        server.sendFeedback(id, { sequence });
      }
      server.setSucceeded(id, { sequence });
    });
    const feedback = collect();
    const { result } = send(client, 3, feedback.add);
    return { result: await result, feedback: feedback.seen };
  },

  "action by operation can fail": async (world) => {
    const { server, client } = await action(world, "/operations/failing", (_, id) =>
      server.setFailed(id),
    );
    return refusal(send(client, 3).result);
  },

  "goal by operation can be cancelled": async (world) => {
    const { server, client } = await action(world, "/operations/patient", (_, id) =>
      server.sendFeedback(id, { sequence: [0] }),
    );
    const goal = send(client, 3, () => client.cancelGoal(goal.id));
    return refusal(goal.result);
  },

  "all goals by operation can be cancelled": async (world) => {
    const { server, client } = await action(world, "/operations/all", (_, id) =>
      server.sendFeedback(id, { sequence: [0] }),
    );
    const running = collect();
    const goals = [1, 2].map((order) => send(client, order, running.add));
    const ends = goals.map(({ result }) => refusal(result));
    await running.many(2);
    client.cancelAllGoals();
    return Promise.all(ends);
  },

  "goals by operation run concurrently": async (world) => {
    const waiting = [];
    const { server, client } = await action(world, "/operations/both", ({ order }, id) => {
      waiting.push([id, order]);
      if (waiting.length < 2) return;
      for (const [each, sent] of waiting.reverse()) server.setSucceeded(each, { sequence: [sent] });
    });
    return Promise.all([send(client, 1).result, send(client, 2).result]);
  },

  "goal by operation fails when its server leaves": async (world) => {
    const { server, client } = await action(world, "/operations/leaving", () => server.ros.close());
    return refusal(send(client, 3).result);
  },

  "goal by operation fails without a server": async ({ library, connect }) => {
    const ros = await connect();
    const client = new library.Action({ ros, name: "/operations/nobody", actionType: FIBONACCI });
    return refusal(send(client, 3).result);
  },

  "action by operation can be unadvertised": async (world) => {
    const { server, client } = await action(world, "/operations/withdrawn", () => {});
    server.unadvertise();
    await world.settled(server.ros);
    return refusal(send(client, 3).result);
  },
};

/** A server that executes goals so and cancels those it is told to, and a client. */
async function action({ library, connect, settled }, name, execute) {
  const options = { name, actionType: FIBONACCI };
  const ros = await connect();
  const server = new library.Action({ ros, ...options });
  server.advertise(execute, (id) => server.setCanceled(id, { sequence: [-1] }));
  await settled(ros);
  return { server, client: new library.Action({ ros: await connect(), ...options }) };
}

function send(client, order, feedback = () => {}) {
  const goal = {};
  goal.result = new Promise((resolve, reject) => {
    const failed = (reason) => reject(new Error(reason));
    goal.id = client.sendGoal({ order }, resolve, feedback, failed);
  });
  return goal;
}
