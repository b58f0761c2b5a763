/** What the page offers in the browser's console: `ROSLIB`, and a connection called `ros`. */
import type { Ros } from "roslib";

import { randomHex, withNode } from "./hub";
import { roslibScript } from "./script_urls";

/** An example for users of roslib. */
export const EXAMPLE = `const fibonacci = new ROSLIB.Topic({ros, name: "/fibonacci", messageType: "std_msgs/Int32"});
fibonacci.subscribe((message) => console.log("I heard", message.data));`;

/** Time between two attempts to connect, or to load roslib, in ms. */
const RETRY = 2000;
/** Time from the first view until roslib is loaded, in ms: the view draws meanwhile. */
const DELAY = 1000;

declare global {
  interface Window {
    /** A connection for the console, which opens when it is first used. */
    readonly ros: Ros;
  }
}

/**
 * Define `ros`, and load `ROSLIB` some time after the first view is shown.
 *
 * `ros` is a node of its own: the page's node is hidden in the graph, but users want to see the
 * subscriptions that they make in the console.
 */
export function offerConsole(url: string, firstView: Promise<void>): void {
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
  void firstView.then(() => setTimeout(() => whenIdle(loadRoslib), DELAY));
}

function loadRoslib(): void {
  const script = document.createElement("script");
  script.addEventListener("load", () => {
    console.info(`ROSLIB and a connection, ros, are available here. Try:\n\n${EXAMPLE}\n`);
  });
  script.addEventListener("error", () => {
    // The hub is down: it may be back later.
    script.remove();
    setTimeout(loadRoslib, RETRY);
  });
  script.src = roslibScript as string;
  document.head.append(script);
}

/** Run something when the browser has nothing urgent to do. */
function whenIdle(run: () => void): void {
  // Safari has no idle callbacks.
  if ("requestIdleCallback" in window) window.requestIdleCallback(run, { timeout: 2000 });
  else run();
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
