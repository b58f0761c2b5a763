/** Types as trees, which only roslib in JavaScript makes of their descriptions. */

import { answer } from "../world.mjs";

export default {
  "message type is decoded into a tree": async ({ connect }) => {
    const ros = await connect();
    const typedefs = await answer((done, failed) =>
      ros.getMessageDetails("geometry_msgs/PoseStamped", done, failed),
    );
    return ros.decodeTypeDefs(typedefs);
  },

  "message type with arrays of messages is decoded into a tree": async ({ connect }) => {
    const ros = await connect();
    const typedefs = await answer((done, failed) =>
      ros.getMessageDetails("actionlib_msgs/GoalStatusArray", done, failed),
    );
    return ros.decodeTypeDefs(typedefs);
  },
};
