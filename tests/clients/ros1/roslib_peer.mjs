/** A peer of the matrix with roslib: node roslib_peer.mjs NAME PEERS MESSAGES.
 *
 * JSON has no infinity and no -0, and JavaScript's numbers have 53 bits: see `values` in the test.
 */

import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";

import ROSLIB from "roslib1";

const KINDS = ["ints", "floats", "image"];
const [name, peers, path] = process.argv.slice(2);
const messages = JSON.parse(readFileSync(path, "utf8"));
const ros = new ROSLIB.Ros({ url: process.env.FIBWS_HUB });

function saw(what, of, value) {
  console.log(JSON.stringify({ saw: what, of, value }));
}

function topic(peer, what, kind, options = {}) {
  const messageType = messages[kind].type;
  return new ROSLIB.Topic({ ros, name: `/${peer}/${what}/${kind}`, messageType, ...options });
}

function hear(what, peer, kind) {
  const heard = topic(peer, what, kind);
  heard.subscribe((message) => {
    heard.unsubscribe();
    saw(`${what} ${kind}`, peer, message);
  });
}

function service(peer) {
  return new ROSLIB.Service({ ros, name: `/${peer}/set_bool`, serviceType: "std_srvs/SetBool" });
}

function call(peer) {
  service(peer).callService(
    { data: true },
    (response) => {
      saw("service", peer, [response.success, response.message]);
      service(peer).callService(
        { data: false },
        () => {},
        () => saw("refusal", peer, null),
      );
    },
    () => setTimeout(call, 200, peer), // It is not there yet.
  );
}

function act(peer) {
  const client = new ROSLIB.ActionClient({
    ros,
    serverName: `/${peer}/act`,
    actionName: "actionlib/TestAction",
  });
  // It has no wait: a goal that nobody has taken is sent again.
  const goal = new ROSLIB.Goal({ actionClient: client, goalMessage: { goal: 21 } });
  const again = setInterval(() => goal.send(), 1000);
  const feedback = [];
  goal.on("status", () => clearInterval(again));
  goal.on("feedback", (each) => {
    feedback.push(each.feedback);
    saw("feedback", peer, each.feedback);
  });
  goal.on("result", (result) => {
    clearInterval(again);
    saw("action", peer, [feedback, result.result]);
  });
  goal.send();
}

await new Promise((resolve) => ros.on("connection", resolve));
const plain = {};
for (const kind of KINDS) {
  topic(name, "latched", kind, { latch: true }).publish(messages[kind].json);
  plain[kind] = topic(name, "plain", kind);
  plain[kind].advertise();
}
new ROSLIB.Param({ ros, name: `/parameters/${name}` }).set(messages.parameters);
service(name).advertise((request, response) => {
  if (request.data) Object.assign(response, { success: true, message: `from ${name}, ä` });
  return request.data;
});
const server = new ROSLIB.SimpleActionServer({
  ros,
  serverName: `/${name}/act`,
  actionName: "actionlib/TestAction",
});
let finish = () => {};
server.on("goal", (goal) => {
  server.sendFeedback({ feedback: goal.goal });
  finish = () => server.setSucceeded({ result: 2 * goal.goal });
});
console.log("ready");
createInterface({ input: process.stdin }).on("line", (line) => {
  if (line === "finish") {
    finish();
    finish = () => {};
    return;
  }
  if (line !== "go") {
    act(line);
    return;
  }
  for (const peer of peers.split(",")) {
    for (const kind of KINDS) {
      hear("latched", peer, kind);
      hear("plain", peer, kind);
    }
    const parameters = new ROSLIB.Param({ ros, name: `/parameters/${peer}` });
    parameters.get((value) => saw("parameters", peer, value));
  }
  for (const peer of messages.serving) {
    call(peer);
  }
  setInterval(() => {
    for (const kind of KINDS) plain[kind].publish(messages[kind].json);
  }, 100);
});
