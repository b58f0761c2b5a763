/** What roslib adds to services in version 2: providers that take their time, and timeouts. */

import { answer, call, refusal } from "../world.mjs";

const TRIGGER = "std_srvs/Trigger";
const never = () => new Promise(() => {});

export default {
  "service may answer later": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/later/trigger", serviceType: TRIGGER };
    await new library.Service(service).advertiseAsync(async () => {
      await new Promise((resolve) => setTimeout(resolve, 10));
      return { success: true, message: "at last" };
    });
    return call(new library.Service(service), {});
  },

  "rejected promise fails the call with its reason": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/rejecting/trigger", serviceType: TRIGGER };
    await new library.Service(service).advertiseAsync(() => Promise.reject("out of paper"));
    return refusal(call(new library.Service(service), {}));
  },

  "call times out": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/slow/trigger", serviceType: TRIGGER };
    await new library.Service(service).advertiseAsync(never);
    const client = new library.Service(service);
    return refusal(answer((done, failed) => client.callService({}, done, failed, 0.1)));
  },

  "call fails when its server leaves": async (world) => {
    const { provider, called, refused } = await hanging(world, "/leaving/trigger");
    await called;
    provider.ros.close();
    return refused;
  },

  "call fails when its server unadvertises": async (world) => {
    const { provider, called, refused } = await hanging(world, "/ending/trigger");
    await called;
    await provider.unadvertise();
    return refused;
  },
};

/** A call that its provider got and will not answer. */
async function hanging({ library, connect, settled }, name) {
  const service = { name, serviceType: TRIGGER };
  const provider = new library.Service({ ros: await connect(), ...service });
  const called = new Promise((resolve) => {
    provider.advertiseAsync(() => {
      resolve();
      return never();
    });
  });
  await settled(provider.ros);
  const client = new library.Service({ ros: await connect(), ...service });
  return { provider, called, refused: refusal(call(client, {})) };
}
