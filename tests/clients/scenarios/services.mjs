/** Services, as the README of roslib uses them. */

import { call, refusal } from "../world.mjs";

const ADD = "rospy_tutorials/AddTwoInts";

function add({ a, b }, response) {
  response.sum = a + b;
  return true;
}

export default {
  "service answers another client": async ({ library, connect, settled }) => {
    const [provider, caller] = [await connect(), await connect()];
    const service = { name: "/add_two_ints", serviceType: ADD };
    await new library.Service({ ros: provider, ...service }).advertise(add);
    await settled(provider);
    return call(new library.Service({ ros: caller, ...service }), { a: 1, b: 2 });
  },

  "client calls its own service": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/own/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    return call(new library.Service(service), { a: 20, b: 22 });
  },

  "missing field of a request is 0": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/short/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    return call(new library.Service(service), { b: 5 });
  },

  "concurrent calls get their own responses": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/busy/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    const client = new library.Service(service);
    const answers = await Promise.all([1, 2, 3].map((a) => call(client, { a, b: 10 })));
    return answers.map(({ sum }) => sum);
  },

  "service reports its failure": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/failing/trigger", serviceType: "std_srvs/Trigger" };
    await new library.Service(service).advertise((_, response) => {
      response.message = "out of paper";
      return false;
    });
    return call(new library.Service(service), {}).catch((error) => ({ failed: error.message }));
  },

  "call of a missing service fails": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/nobody/trigger", serviceType: "std_srvs/Trigger" };
    return refusal(call(new library.Service(service), {}));
  },

  "call of an unadvertised service fails": async ({ library, connect, settled }) => {
    const ros = await connect();
    const service = { ros, name: "/brief/add_two_ints", serviceType: ADD };
    const provider = new library.Service(service);
    await provider.advertise(add);
    await settled(ros);
    await provider.unadvertise();
    await settled(ros);
    return refusal(call(new library.Service(service), { a: 1, b: 2 }));
  },

  "invalid request fails": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/strict/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    return refusal(call(new library.Service(service), { a: "one", b: 2 }));
  },
};
