/** What a page gets wrong that has the line of the documentation. */

import { makeMistakes } from "../mistakes.mjs";

export default {
  mistakes: async (world) => {
    const ros = world.create(`${world.url}/?node=/mistaken`);
    ros.on("status", (status) => console.error(JSON.stringify(status)));
    await new Promise((resolve) => ros.on("connection", resolve));
    await makeMistakes(world, ros);
  },
};
