/** Shows why no connection to the hub opens, and what mends it. */
import "./connection_problem.css";

import { copyable } from "./copy_button";
import { h, replace } from "./dom";
import type { Hub } from "./hub";
import { askHub, type OriginAnswer } from "./origin";

export interface Problem {
  readonly text: string;
  /** The command to start the hub with; empty if that would not help. */
  readonly command: string;
}

/** After so many failures to connect, the hub is asked again. */
const ASK_EACH = 3;

/**
 * What keeps a page from connecting to a hub for the first time.
 *
 * `answer` is undefined if the hub does not answer HTTP requests, either.
 */
export function problemOf(
  url: string,
  answer: OriginAnswer | undefined,
  failures: number,
): Problem | undefined {
  if (answer?.allowed === false) {
    return {
      text: `The hub refuses this page: ${answer.reason}.`,
      command: `python -m fibws.hub ${answer.option}`,
    };
  }
  // The hub may just be starting.
  if (failures < ASK_EACH) return undefined;
  if (answer === undefined) {
    return { text: `No hub answers at ${url}. ${advice(url)}`, command: "" };
  }
  return {
    text:
      "The hub answers HTTP requests, but no WebSocket opens. A proxy between this page and the " +
      "hub must pass the headers Upgrade and Connection on. If there is none, the hub's log says " +
      "more: it may have too many clients.",
    command: "",
  };
}

/** What to do if nothing answers; nodes and commands say the same. */
function advice(url: string): string {
  const { protocol, hostname, port } = new URL(url);
  if (port === "") {
    const tried = protocol === "wss:" ? 443 : 80;
    return `Without a port in the address, it is ${tried}: perhaps ${protocol}//${hostname}:9090.`;
  }
  return "Check the address, and that a hub is running there.";
}

/** A box that is visible while a problem is known. */
export function connectionProblem(hub: Hub): HTMLElement {
  const box = h("div", { class: "connection-problem", role: "alert", hidden: true });
  const show = (problem: Problem | undefined): void => {
    box.hidden = problem === undefined;
    replace(
      box,
      problem && h("p", {}, problem.text),
      problem?.command && copyable(problem.command, "the hub's command"),
    );
  };
  let opened = false;
  let shown = "";
  hub.state.watch((state) => {
    if (state !== "open") return;
    opened = true;
    shown = "";
    show(undefined);
  });
  hub.failures.watch(async (failures) => {
    if (failures === 0 || (failures % ASK_EACH !== 0 && (opened || failures > 1))) return;
    const answer = await askHub(hub.url);
    // A hub that let the page in is most likely down: the header says that already.
    const problem =
      opened && answer === undefined ? undefined : problemOf(hub.url, answer, failures);
    if (hub.state.value === "open" || problem === undefined || problem.text === shown) return;
    shown = problem.text;
    show(problem);
  });
  return box;
}
