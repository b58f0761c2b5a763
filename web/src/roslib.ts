/** The entry of /roslib.js: roslib 2, and the classes of roslib 1 that tutorials use. */

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
