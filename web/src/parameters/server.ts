/** The hub's parameter server, by the services of rosapi. */
import type { Hub } from "../hub";

/** Questions at once: a client may have a thousand open, and others want some of the hub, too. */
const AT_ONCE = 32;
/** What is asked for if a parameter went away meanwhile; no parameter can have this value. */
const GONE = "null";

export class ParameterServer {
  readonly #hub: Hub;

  constructor(hub: Hub) {
    this.#hub = hub;
  }

  /** All parameters, by name, each with its JSON text: a number keeps all of its digits so. */
  async all(): Promise<[name: string, value: string][]> {
    const { names } = await this.#call<{ names: string[] }>("get_param_names", "GetParamNames", {});
    const values = new Map<string, string>();
    const waiting = names.values();
    const ask = async () => {
      for (const name of waiting) {
        const request = { name, default: GONE };
        const { value } = await this.#call<{ value: string }>("get_param", "GetParam", request);
        if (value !== GONE) values.set(name, value);
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, ask));
    return names.flatMap((name) => {
      const value = values.get(name);
      return value === undefined ? [] : [[name, value]];
    });
  }

  /** All parameters as one text, to tell whether any of them changed. */
  async text(): Promise<string> {
    const request = { name: "/", default: GONE };
    return (await this.#call<{ value: string }>("get_param", "GetParam", request)).value;
  }

  async set(name: string, value: string): Promise<void> {
    await this.#call("set_param", "SetParam", { name, value });
  }

  async remove(name: string): Promise<void> {
    await this.#call("delete_param", "DeleteParam", { name });
  }

  #call<T>(service: string, type: string, request: Record<string, string>): Promise<T> {
    return this.#hub.call<T>(`/rosapi/${service}`, `rosapi/${type}`, request);
  }
}
