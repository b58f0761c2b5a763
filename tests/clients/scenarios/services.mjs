/** Services, as the README of roslib uses them. */

import { call, refusal } from "../world.mjs";

const ADD = "rospy_tutorials/AddTwoInts";

function add({ a, b }, response) {
  response.sum = a + b;
  return true;
}

export default {
  "a service answers another client": async ({ library, connect, settled }) => {
    const [provider, caller] = [await connect(), await connect()];
    const service = { name: "/add_two_ints", serviceType: ADD };
    await new library.Service({ ros: provider, ...service }).advertise(add);
    await settled(provider);
    return call(new library.Service({ ros: caller, ...service }), { a: 1, b: 2 });
  },

  "a service answers its own client": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/own/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    return call(new library.Service(service), { a: 20, b: 22 });
  },

  "a field that the request leaves out is 0": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/short/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    return call(new library.Service(service), { b: 5 });
  },

  "calls that overlap get each its own answer": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/busy/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    const client = new library.Service(service);
    const answers = await Promise.all([1, 2, 3].map((a) => call(client, { a, b: 10 })));
    return answers.map(({ sum }) => sum);
  },

  "a service says that it failed": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/failing/trigger", serviceType: "std_srvs/Trigger" };
    await new library.Service(service).advertise((_, response) => {
      response.message = "out of paper";
      return false;
    });
    return call(new library.Service(service), {}).catch((error) => ({ failed: error.message }));
  },

  "a service that is not there fails": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/nobody/trigger", serviceType: "std_srvs/Trigger" };
    return refusal(call(new library.Service(service), {}));
  },

  "a service that is no longer there fails": async ({ library, connect, settled }) => {
    const ros = await connect();
    const service = { ros, name: "/brief/add_two_ints", serviceType: ADD };
    const provider = new library.Service(service);
    await provider.advertise(add);
    await settled(ros);
    await provider.unadvertise();
    await settled(ros);
    return refusal(call(new library.Service(service), { a: 1, b: 2 }));
  },

  "a request that does not fit the type fails": async ({ library, connect }) => {
    const service = { ros: await connect(), name: "/strict/add_two_ints", serviceType: ADD };
    await new library.Service(service).advertise(add);
    return refusal(call(new library.Service(service), { a: "one", b: 2 }));
  },
};
