/** What a scenario is given: a client library, connections to the hub, and a way to speak. */

/**
 * @param library the client library, as its users import it
 * @param url where the hub is
 * @param report takes one JSON value: what the tests in Python read
 */
export function world(library, url, report) {
  let opening = Promise.resolve();

  /** A connection to an address, which is about to open. */
  function create(address, options = {}) {
    // Without an encoding roslib 1.4.1 complains on every connection in Node.
    return new library.Ros({ url: address, encoding: "utf8", ...library.options, ...options });
  }

  /** A connection that is open. */
  function open({ node, status = (text) => report({ complaint: text }), ...options }) {
    const ros = create(node ? `${url}/?node=${node}` : url, options);
    ros.on("error", (error) => report({ complaint: `error event: ${describe(error)}` }));
    const emit = ros.emit;
    ros.emit = function (event, ...values) {
      // Statuses are events named after the operation's id, which roslib tells nobody.
      if (String(event).startsWith("status")) status(`${values[0].level}: ${values[0].msg}`);
      return emit.call(this, event, ...values);
    };
    return new Promise((resolve) => ros.once("connection", () => resolve(ros)));
  }

  return {
    library,
    url,
    report,
    create,

    /**
     * A connection that is open, by the name of `node` if one is given.
     *
     * At its default level the hub sends statuses of errors only, so each is a complaint about
     * the client, unless the scenario waits for it with `status`.
     */
    connect(options = {}) {
      // One after the other: Chromium keeps pages waiting for seconds that open many at once.
      opening = opening.then(() => open(options));
      return opening;
    },

    /** Resolves when the hub has done all that this connection asked for before. */
    settled(ros) {
      const clock = { name: "/rosapi/get_time", serviceType: "rosapi/GetTime" };
      return call(new library.Service({ ros, ...clock }), {});
    },
  };
}

/** Runs the scenarios, all at once, and reports what each of them saw. */
export async function run(scenarios, world) {
  const outcomes = Object.entries(scenarios).map(async ([scenario, play]) => {
    try {
      world.report({ scenario, saw: plain(await play(world)) });
    } catch (error) {
      world.report({ scenario, failed: describe(error) });
    }
  });
  await Promise.all(outcomes);
  world.report({ done: true });
}

/** The answer of a method that takes a callback, and another one for failures. */
export function answer(method) {
  return new Promise((resolve, reject) => {
    method(resolve, (reason) => reject(new Error(reason)));
  });
}

/** What a service answers. */
export function call(service, request) {
  return answer((done, failed) => service.callService(request, done, failed));
}

/** Why something was refused. */
export async function refusal(promise) {
  let value;
  try {
    value = await promise;
  } catch (error) {
    return error.message;
  }
  throw new Error(`It was not refused but gave ${JSON.stringify(value)}.`);
}

/** Collects the values given to `add`; `many` resolves as soon as there are that many. */
export function collect() {
  const seen = [];
  let look = () => {};
  return {
    seen,
    add(value) {
      seen.push(value);
      look();
    },
    many(count) {
      return new Promise((resolve) => {
        look = () => seen.length >= count && resolve([...seen]);
        look();
      });
    },
  };
}

export const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

export function describe(error) {
  return error?.stack ?? error?.message ?? (typeof error === "string" ? error : String(error?.type));
}

/** The same value in what JSON can say: a typed array as an object named after its class. */
function plain(value) {
  if (ArrayBuffer.isView(value)) return { [value.constructor.name]: Array.from(value) };
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value ?? null;
  return Object.fromEntries(Object.entries(value).map(([name, field]) => [name, plain(field)]));
}
