/** Transforms by way of tf2_web_republisher. */

import { collect } from "../world.mjs";

export default {
  "transforms arrive by action": (world) => follow(world, "by_action"),
};

/** How a client listens to frames here. */
export const LISTENING = { fixedFrame: "world", angularThres: 0.01, transThres: 0.01, rate: 50 };

/** Moves a frame twice and listens to it with a client of this class. */
export async function follow(
  { library, connect, settled },
  frame,
  { client = "TFClient", ...options } = {},
) {
  const ros = await connect(options);
  const tf = new library[client]({ ros, ...LISTENING });
  const heard = collect();
  tf.subscribe(frame, ({ translation, rotation }) => heard.add({ translation, rotation }));
  const topic = new library.Topic({ ros, name: "/tf", messageType: "tf2_msgs/TFMessage" });
  const quarter = { x: 0, y: 0, z: Math.SQRT1_2, w: Math.SQRT1_2 };
  move(topic, frame, { x: 1, y: 2, z: 3 }, quarter);
  await heard.many(1);
  move(topic, frame, { x: 4, y: 5, z: 6 }, quarter);
  const transforms = await heard.many(2);
  tf.dispose();
  await settled(ros);
  return transforms;
}

export function move(topic, child_frame_id, translation, rotation) {
  const now = Date.now();
  const stamp = { secs: Math.floor(now / 1000), nsecs: (now % 1000) * 1e6 };
  const header = { stamp, frame_id: "world" };
  const transform = { translation, rotation };
  topic.publish({ transforms: [{ header, child_frame_id, transform }] });
}
