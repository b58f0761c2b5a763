/**
 * The entry of /roslib.js and /roslib.mjs: roslib 2, and the classes of roslib 1 that tutorials use.
 *
 * Its `Ros` writes to the browser's console what roslib drops: the hub's statuses, such as that of a
 * refused message, and why the hub refuses the page.
 */
import { Ros as RoslibRos } from "roslib";

import { askHub } from "./origin";

export * from "roslib";

declare global {
  /** Defined once /roslib.js is loaded. The page's own modules import only its types. */
  var ROSLIB: typeof import("./roslib");
}

class Values {
  constructor(values?: object) {
    Object.assign(this, values);
  }
}

/** For `topic.publish(new ROSLIB.Message({data: 8}))`; roslib 2 also accepts plain objects. */
export class Message extends Values {}

/** For `service.callService(new ROSLIB.ServiceRequest({a: 1, b: 2}), ...)`. */
export class ServiceRequest extends Values {}

/** The response of a service that a page provides. */
export class ServiceResponse extends Values {}

/** An operation that the hub sends, as far as it is of interest here. */
interface Status {
  op: "status";
  /** The operation's id; a hub sends one of roslib's to pages as `operation`. */
  id?: string;
  operation?: string;
  level: string;
  msg: string;
}

/** Hubs that have been asked why they refuse this page. */
const asked = new Set<string>();

export class Ros extends RoslibRos {
  /**
   * Pass an event on; statuses that the page has no listener for go to the console.
   *
   * roslib gives the status of an operation only to listeners of `status:` and the operation's id,
   * which pages do not know. Here listeners of `status` receive it, too.
   */
  override emit(...parameters: Parameters<RoslibRos["emit"]>): boolean {
    const [event, status] = parameters;
    if (event === "close") logClose(status);
    const isReceived = super.emit(...parameters);
    if (isReceived || !isStatus(status)) return isReceived;
    if (event !== "status" && super.emit("status", status)) return true;
    logStatus(status);
    return false;
  }

  override connect(url: string): Promise<void> {
    const explain = (): void => {
      this.off("connection", forget);
      void explainRefusal(url);
    };
    const forget = (): void => {
      this.off("error", explain);
    };
    this.once("error", explain);
    this.once("connection", forget);
    return super.connect(url);
  }
}

function isStatus(operation: unknown): operation is Status {
  return typeof operation === "object" && operation !== null && Object(operation).op === "status";
}

/** Write to the console why the hub has ended a connection: its codes are those from 4000 on. */
function logClose(event: unknown): void {
  const { code, reason } = Object(event) as Partial<CloseEvent>;
  if (code && code >= 4000) console.error(`The hub has closed the connection: ${reason} (${code})`);
}

/** roslib's ids, such as `publish:/chatter:123236e9-e205-45c3-992d-4d186e547b2a`. */
const ROSLIB_ID = /^[a-z_]+:(.*):[0-9a-f]{8}-[0-9a-f-]{27}$/;

function logStatus({ id, operation = id, level, msg }: Status): void {
  const about = operation?.replace(ROSLIB_ID, "$1");
  const text = `The hub says${about ? ` about ${about}` : ""}: ${msg}`;
  if (level === "error") console.error(text);
  else if (level === "warning") console.warn(text);
  else console.info(text);
}

/** Write to the console why a hub refuses this page, once for each hub. */
async function explainRefusal(url: string): Promise<void> {
  if (asked.has(url)) return;
  asked.add(url);
  const answer = await askHub(url);
  if (answer?.allowed === false) console.error(`The hub refuses this page: ${answer.reason}.`);
}
