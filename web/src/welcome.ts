/** What to do next: shown by an empty hub, and to whoever asks for help. */
import "./welcome.css";

import { EXAMPLE } from "./browser_console";
import { copyable } from "./copy";
import { h } from "./dom";

/** Where a program finds the hub by itself. */
const DEFAULT_PORT = "9090";

/** The steps, for the hub at a WebSocket address. */
export function welcome(url: string): HTMLElement {
  const address = url.replace(/\/$/, "");
  const site = address.replace(/^ws/, "http");
  const hub = isDefault(address) ? "" : ` --hub ${address}`;
  return h(
    "div",
    { class: "welcome" },
    h(
      "p",
      { class: "lead" },
      "Nodes and web pages meet here: it is the ROS graph over WebSockets, with no ROS installed.",
    ),
    h(
      "ol",
      {},
      step(
        "Start two nodes",
        "Each in a terminal of its own. One publishes the Fibonacci numbers, the other prints " +
          "them; both appear here.",
        copyable(`python -m fibws.broadcaster${hub}`, "the broadcaster's command"),
        copyable(`python -m fibws.listener${hub}`, "the listener's command"),
      ),
      step(
        "Hear them in this browser",
        "Open this page's console (F12, then “Console”) and paste:",
        copyable(snippet(address), "the console's snippet"),
        h(
          "p",
          {},
          "Or with roslib: ",
          h("code", {}, "ROSLIB"),
          " and a connection, ",
          h("code", {}, "ros"),
          ", are at hand there.",
        ),
        copyable(EXAMPLE, "the snippet for roslib"),
      ),
      step(
        "Write a page of your own",
        "Any page that localhost serves may connect; for one opened as a file, start the hub with " +
          "--allow-origin null. roslib comes from this hub, in one file:",
        copyable(page(site, address), "the beginning of a page"),
        h(
          "p",
          { class: "soft small" },
          h("a", { href: "roslib.js" }, "roslib.js"),
          " · how the hub is doing: ",
          h("a", { href: "healthz" }, "healthz"),
        ),
      ),
    ),
  );
}

/** The same, over whatever is in sight. */
export function help(url: string): void {
  const dialog = h(
    "dialog",
    { class: "help", "aria-label": "Help" },
    h(
      "form",
      { method: "dialog", class: "toolbar" },
      h("h2", { class: "grow" }, "What to do next"),
      h("button", { class: "end" }, "Close"),
    ),
    welcome(url),
  );
  dialog.addEventListener("close", () => dialog.remove());
  // A click that hits the dialog itself, and nothing in it, is one beside it.
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
}

function step(title: string, text: string, ...pieces: HTMLElement[]): HTMLElement {
  return h("li", {}, h("h3", {}, title), h("p", {}, text), ...pieces);
}

/** The README's: with nothing but what each browser has. */
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

function isDefault(address: string): boolean {
  const { hostname, port } = new URL(address);
  return port === DEFAULT_PORT && ["localhost", "127.0.0.1", "[::1]"].includes(hostname);
}
