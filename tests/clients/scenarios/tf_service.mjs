/** Transforms by way of tf2_web_republisher's service, which roslib has in version 1 alone. */

import { follow } from "./tf.mjs";

export default {
  "transforms arrive by service": (world) =>
    follow(world, "by_service", { groovyCompatibility: false }),
};
