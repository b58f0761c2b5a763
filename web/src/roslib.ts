// What /roslib.js is built from: roslib 2, and the names of roslib 1 that tutorials' pages use.

export * from "roslib";

declare global {
  /** All of this, where a page has loaded /roslib.js; what else is bundled imports only its types. */
  var ROSLIB: typeof import("./roslib");
}

class Values {
  constructor(values?: object) {
    Object.assign(this, values);
  }
}

/** What `topic.publish(new ROSLIB.Message({data: 8}))` sends; roslib 2 takes the bare object as well. */
export class Message extends Values {}

/** What `service.callService(new ROSLIB.ServiceRequest({a: 1, b: 2}), ...)` sends. */
export class ServiceRequest extends Values {}

/** What a service of the page's own answers with. */
export class ServiceResponse extends Values {}
