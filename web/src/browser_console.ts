/** What is at hand in the page's own console: `ROSLIB`, and a connection called `ros`. */
import type { Ros } from "roslib";

import { asNode, randomHex } from "./hub";

/** Two lines to begin with. */
export const EXAMPLE = `const fibonacci = new ROSLIB.Topic({ros, name: "/fibonacci", messageType: "std_msgs/Int32"});
fibonacci.subscribe((message) => console.log("I heard", message.data));`;

/** Time between two attempts to connect again, in ms. */
const PAUSE = 2000;

declare global {
  interface Window {
    /** A connection of your own, which opens when you first use it. */
    readonly ros: Ros;
  }
}

/**
 * Put `ros` at hand, and say so.
 *
 * It is a node of its own: the page's is hidden from the graph, and whoever subscribes from the
 * console wants to see that there.
 */
export function offer(url: string): void {
  let ros: Ros | undefined;
  Object.defineProperty(window, "ros", {
    configurable: true,
    get: () => (ros ??= connected(url)),
    // `const ros = …` of a pasted tutorial shadows it; `ros = …` takes its place.
    set: (value: Ros) => {
      ros = value;
    },
  });
  console.info(`ROSLIB and a connection, ros, are at hand here. Try:\n\n${EXAMPLE}\n`);
}

function connected(url: string): Ros {
  const ros = new ROSLIB.Ros();
  const address = asNode(url, `/browser_${randomHex()}`);
  const connect = () => void ros.connect(address).catch(console.error);
  ros.on("close", () => window.setTimeout(connect, PAUSE));
  ros.on("error", () => undefined);
  connect();
  return ros;
}
