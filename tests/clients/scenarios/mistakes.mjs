/** What a page gets wrong that says nothing itself. */

import { makeMistakes } from "../mistakes.mjs";

export default {
  mistakes: async (world) => {
    const ros = world.create(`${world.url}/?node=/mistaken`);
    await new Promise((resolve) => ros.on("connection", resolve));
    await makeMistakes(world, ros);
  },
};
