/** First steps: shown for an empty hub, and as help. */
import "./welcome.css";

import { EXAMPLE, loadRoslib } from "./browser_console";
import { copyable } from "./copy_button";
import { h } from "./dom";
import { applicationLink, FOXGLOVE, LICHTBLICK } from "./foxglove";
import { isDefaultHub } from "./hub";

/** The first steps with the hub at a WebSocket address. */
export function welcome(url: string): HTMLElement {
  const address = url.replace(/\/$/, "");
  const site = address.replace(/^ws/, "http");
  const hub = isDefaultHub(url) ? "" : ` --hub ${address}`;
  return h(
    "div",
    { class: "welcome" },
    h(
      "p",
      { class: "lead" },
      "This hub connects nodes and web pages: the ROS graph over WebSockets, without ROS.",
    ),
    h(
      "ol",
      {},
      step(
        "Start two nodes",
        "Each in its own terminal. One publishes the Fibonacci numbers, the other prints them. " +
          "Both appear on this page.",
        copyable(`python -m fibws.broadcaster${hub}`, "the command of the broadcaster"),
        copyable(`python -m fibws.listener${hub}`, "the command of the listener"),
      ),
      step(
        "Receive them in this browser",
        "Open the console of this page (F12, then “Console”) and paste:",
        copyable(snippet(address), "the snippet"),
        h(
          "p",
          {},
          "Or use roslib: ",
          h("code", {}, "ROSLIB"),
          " and a connection, ",
          h("code", {}, "ros"),
          ", are available there.",
        ),
        copyable(EXAMPLE, "the snippet for roslib"),
      ),
      step(
        "Write your own page",
        "Pages served by localhost may connect. For a page opened as a file, start the hub with " +
          "--allow-origin null. The hub serves roslib as one file:",
        copyable(page(site, address), "the page"),
        h(
          "p",
          { class: "soft small" },
          h("a", { href: "roslib.js" }, "roslib.js"),
          " · the hub's health: ",
          h("a", { href: "healthz" }, "healthz"),
        ),
      ),
      step(
        "Open it in Foxglove or Lichtblick",
        "The hub speaks the protocol of their “Foxglove WebSocket” connections. Their pages may " +
          "connect once the hub is started with their origin:",
        copyable(
          `python -m fibws.hub ${[FOXGLOVE, LICHTBLICK].map(allowed).join(" ")}`,
          "the command of the hub",
        ),
        h(
          "p",
          { class: "soft small" },
          applicationLink(FOXGLOVE, url, "Foxglove"),
          " · ",
          applicationLink(LICHTBLICK, url, "Lichtblick"),
          " · in their desktop applications, connect to ",
          h("code", {}, address),
        ),
      ),
    ),
  );
}

/** Show the first steps in a dialog. */
export function showHelp(url: string): void {
  loadRoslib();
  const dialog = h(
    "dialog",
    { class: "help", "aria-label": "Help" },
    h(
      "form",
      { method: "dialog", class: "toolbar" },
      h("h2", { class: "grow" }, "First steps"),
      h("button", { class: "end" }, "Close"),
    ),
    welcome(url),
  );
  dialog.addEventListener("close", () => dialog.remove());
  // A click on the dialog itself, not on anything in it, is outside of its box.
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
}

function step(title: string, text: string, ...pieces: HTMLElement[]): HTMLElement {
  return h("li", {}, h("h3", {}, title), h("p", {}, text), ...pieces);
}

/** The option of the hub that lets an application's page connect. */
function allowed(application: string): string {
  return `--allow-origin ${new URL(application).origin}`;
}

/** The snippet of the README, which needs no library. */
function snippet(address: string): string {
  return `const hub = new WebSocket("${address}");
const subscribe = {op: "subscribe", topic: "/fibonacci", type: "std_msgs/Int32"};
hub.onopen = () => hub.send(JSON.stringify(subscribe));
hub.onmessage = (event) => console.log("I heard", JSON.parse(event.data).msg.data);
hub.onclose = (event) => console.log("The hub has closed:", event.reason || event.code);`;
}

function page(site: string, address: string): string {
  return `<script src="${site}/roslib.js"></script>
<script>
  const ros = new ROSLIB.Ros({url: "${address}"});
  const topic = new ROSLIB.Topic({ros, name: "/fibonacci", messageType: "std_msgs/Int32"});
  topic.subscribe((message) => document.body.append(message.data + " "));
</script>`;
}
