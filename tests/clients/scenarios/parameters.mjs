/** Parameters, as the README of roslib uses them. */

import { answer } from "../world.mjs";

export default {
  "parameter can be set read listed and deleted": async ({ library, connect }) => {
    const ros = await connect();
    const param = new library.Param({ ros, name: "/camera/gains" });
    const names = () => answer((done, failed) => ros.getParams(done, failed));
    await set(param, { red: 1.5, blue: [1, 2], label: "wörld", on: true });
    const value = await get(param);
    const listed = (await names()).filter((name) => name.startsWith("/camera"));
    await answer((done) => param.delete(done, done));
    return { value, listed, after: (await names()).filter((name) => name.startsWith("/camera")) };
  },

  "parameter inside another one can be read alone": async ({ library, connect }) => {
    const ros = await connect();
    await set(new library.Param({ ros, name: "/arm" }), { joints: { elbow: 3 } });
    return get(new library.Param({ ros, name: "/arm/joints/elbow" }));
  },

  "missing parameter is null": async ({ library, connect }) =>
    get(new library.Param({ ros: await connect(), name: "/never_set" })),

  "parameters of the hub exist": async ({ library, connect }) =>
    get(new library.Param({ ros: await connect(), name: "/rosdistro" })),

  "parameter is read by another client": async ({ library, connect }) => {
    await set(new library.Param({ ros: await connect(), name: "/max_vel_x" }), 0.8);
    return get(new library.Param({ ros: await connect(), name: "/max_vel_x" }));
  },
};

const get = (param) => answer((done, failed) => param.get(done, failed));
const set = (param, value) => answer((done, failed) => param.set(value, done, failed));
