/** What the page offers in the browser's console: `ROSLIB`, and a connection called `ros`. */
import type { Ros } from "roslib";

import { randomHex, withNode } from "./hub";
import { roslibScript } from "./script_urls";

/** An example for users of roslib. */
export const EXAMPLE = `const fibonacci = new ROSLIB.Topic({ros, name: "/fibonacci", messageType: "std_msgs/Int32"});
fibonacci.subscribe((message) => console.log("I heard", message.data));`;

/** Time between two attempts to connect, in ms. */
const RETRY = 2000;
declare global {
  interface Window {
    /** A connection for the console, which opens when it is first used. */
    readonly ros: Ros;
  }
}

/**
 * Define `ros` and `ROSLIB`, which is loaded when one of them is first used: few people ever do.
 *
 * `ros` is a node of its own: the page's node is hidden in the graph, but users want to see the
 * subscriptions that they make in the console.
 */
export function offerConsole(url: string): void {
  let ros: Ros | undefined;
  Object.defineProperty(window, "ros", {
    configurable: true,
    get: () => (ros ??= connected(url)),
    // `const ros = …` of a pasted tutorial shadows it; `ros = …` replaces it.
    set: (value: Ros) => {
      ros = value;
    },
  });
  Object.defineProperty(window, "ROSLIB", {
    configurable: true,
    get: () => {
      loadRoslib();
      throw new Error("roslib is being loaded; run this again in a moment");
    },
    // What the script does.
    set: (value: unknown) => {
      Object.defineProperty(window, "ROSLIB", { value, configurable: true, writable: true });
    },
  });
  console.info(`Type ROSLIB to load roslib here, and a connection, ros. Then try:\n\n${EXAMPLE}\n`);
}

let isLoading = false;

/** Load roslib, if it is not: somebody reads how to use it, or does. */
export function loadRoslib(): void {
  if (isLoading) return;
  isLoading = true;
  const script = document.createElement("script");
  script.addEventListener("load", () => console.info("ROSLIB and ros are ready."));
  script.addEventListener("error", () => {
    // The hub is down: it may be back when somebody tries again.
    script.remove();
    isLoading = false;
  });
  script.src = roslibScript as string;
  document.head.append(script);
}

function connected(url: string): Ros {
  const ros = new ROSLIB.Ros();
  const address = withNode(url, `/browser_${randomHex()}`);
  const connect = () => void ros.connect(address).catch(console.error);
  ros.on("close", () => window.setTimeout(connect, RETRY));
  ros.on("error", () => undefined);
  connect();
  return ros;
}
