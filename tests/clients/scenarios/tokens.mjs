/** A hub that wants a token; the world's URL has one, which may use all names below /allowed. */

import { collect } from "../world.mjs";

export default {
  "token in the url lets a client in": async (world) => echoed(world, await world.connect(), "/url"),

  "token follows by the operation auth": async (world) => {
    const { bare, token } = parts(world);
    const ros = world.create(bare);
    ros.callOnConnection({ op: "auth", token });
    return echoed(world, ros, "/auth");
  },

  "wrong token closes the connection": async (world) => {
    const ros = world.create(`${parts(world).bare}?token=wrong`);
    await new Promise((resolve) => ros.once("close", resolve));
    return "closed";
  },

  "missing right is named": async (world) => {
    const seen = collect();
    const ros = await world.connect({ status: seen.add });
    const messageType = "std_msgs/Int32";
    new world.library.Topic({ ros, name: "/forbidden", messageType }).advertise();
    return seen.many(1);
  },
};

function parts({ url }) {
  const bare = new URL(url);
  const token = bare.searchParams.get("token");
  bare.search = "";
  return { bare: bare.href, token };
}

/** The message that a client receives from itself. */
async function echoed({ library }, ros, name) {
  const messageType = "std_msgs/Int32";
  const seen = collect();
  const topic = (latch) =>
    new library.Topic({ ros, name: `/allowed${name}`, messageType, latch });
  topic(false).subscribe(seen.add);
  topic(true).publish({ data: 8 });
  return (await seen.many(1))[0];
}
