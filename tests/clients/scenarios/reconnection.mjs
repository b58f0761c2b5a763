/** A hub that goes away and another one in its place: user code connects again on `close`. */

import { collect } from "../world.mjs";

export default {
  "client reconnects when the hub returns": async ({ library, url, report, settled }) => {
    const returns = collect();
    const connect = () => {
      const ros = new library.Ros({ url, encoding: "utf8", ...library.options });
      ros.on("connection", () => returns.add(ros));
      ros.on("error", () => {}); // No hub is there for a while.
      ros.on("close", () => setTimeout(() => ros.connect(url), 1000));
      return ros;
    };
    const [talker, listener] = [connect(), connect()];
    await returns.many(2);
    const service = { name: "/echo", serviceType: "std_srvs/SetBool" };
    if (library.Service) {
      const ros = talker;
      await new library.Service({ ros, ...service }).advertise((request, response) => {
        response.success = request.data;
        return true;
      });
      ros.on("connection", () =>
        ros.callOnConnection({ op: "advertise_service", service: "/echo", type: "std_srvs/SetBool" }),
      );
    }
    const chatter = { name: "/chatter", messageType: "std_msgs/String" };
    const received = collect();
    new library.Topic({ ros: listener, ...chatter }).subscribe(received.add);
    await settled(listener);
    const topic = new library.Topic({ ros: talker, ...chatter });
    topic.publish({ data: "before" });
    await received.many(1);
    report({ restart: true });
    await returns.many(4);
    await settled(listener);
    topic.publish({ data: "after" });
    const called = new Promise((resolve, reject) =>
      new library.Service({ ros: listener, ...service }).callService(
        { data: true },
        resolve,
        reject,
      ),
    );
    return [...(await received.many(2)), await called];
  },
};
