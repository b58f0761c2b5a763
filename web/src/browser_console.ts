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
 * Define `ros` and load `ROSLIB`, once the page has nothing else to load.
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
      throw new Error("roslib is still being loaded; try again in a moment");
    },
    // What the script does.
    set: (value: unknown) => {
      Object.defineProperty(window, "ROSLIB", { value, configurable: true, writable: true });
    },
  });
  if (document.readyState === "complete") loadRoslib();
  else window.addEventListener("load", loadRoslib, { once: true });
}

function loadRoslib(): void {
  const script = document.createElement("script");
  script.addEventListener("load", () => {
    console.info(`ROSLIB and a connection, ros, are available here. Try:\n\n${EXAMPLE}\n`);
  });
  script.addEventListener("error", () => console.warn("roslib.js could not be loaded"));
  script.src = roslibScript as string;
  whenIdle(() => document.head.append(script));
}

/** Run something when the browser has nothing more urgent to do. */
function whenIdle(run: () => void): void {
  // Safari has no idle callbacks.
  if ("requestIdleCallback" in window) window.requestIdleCallback(run, { timeout: 2000 });
  else setTimeout(run, 500);
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
