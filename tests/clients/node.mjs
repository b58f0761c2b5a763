/** Runs scenarios in Node: node node.mjs LIBRARY URL SCENARIOS... */

import { format } from "node:util";

import { describe, run, world } from "./world.mjs";

const LIBRARIES = {
  "roslib 1.4.1": async () => (await import("roslib1")).default,
  "roslib 2.1.0": () => import("roslib2"),
  "foxglove/roslibjs": async () => {
    globalThis.WebSocket = (await import("ws")).WebSocket; // It is built for browsers.
    return (await import("@foxglove/roslibjs")).default;
  },
  "foxglove/ws-protocol": async () => {
    globalThis.WebSocket = (await import("ws")).WebSocket;
    return (await import("@foxglove/ws-protocol")).default.FoxgloveClient;
  },
};

// The one that Node has from version 22 on does not say when a connection was refused.
delete globalThis.WebSocket;

const [library, url, ...files] = process.argv.slice(2);
const report = (line) => console.log(JSON.stringify(line));

for (const level of ["error", "warn"]) {
  console[level] = (...values) => report({ complaint: `console.${level}: ${format(...values)}` });
}
process.on("uncaughtException", (error) => report({ complaint: `uncaught: ${describe(error)}` }));
process.on("unhandledRejection", (error) => report({ complaint: `unhandled: ${describe(error)}` }));

const scenarios = await Promise.all(files.map((file) => import(`./scenarios/${file}.mjs`)));
await run(
  Object.assign({}, ...scenarios.map((each) => each.default)),
  world(await LIBRARIES[library](), url, report),
);
process.exit(0); // A SimpleActionServer goes on publishing its status for ever.
