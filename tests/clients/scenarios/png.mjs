/** Messages as PNG pictures of their JSON, which Foxglove's fork of roslib does not know. */

import { heard } from "./encodings.mjs";

export default {
  "message arrives as png": (world) =>
    heard(world, "png", "/png/text", "std_msgs/String", { data: "hello, wörld 🌍" }),

  "long message arrives as png": async (world) => {
    const sent = "0123456789".repeat(10_000);
    const { data } = await heard(world, "png", "/png/long", "std_msgs/String", { data: sent });
    return { equal: data === sent, length: data.length };
  },
};
