/** The page at a hub that wants a token; `login_form` has what is seen of it. */
import type { Hub } from "./hub";
import { type Signal, Source } from "./signal";

/** The hub's answer at `/login`: who the page is by its cookie. */
export interface Who {
  /** Whether the hub wants a token. */
  required: boolean;
  /** null if the hub does not let the page in. */
  name: string | null;
  admin: boolean;
  /** Why the hub does not let the page in. */
  reason: string;
}

/** Who enters without a token, if the hub allows that. */
export const ANONYMOUS = "anonymous";

/**
 * The page's token and identity.
 *
 * At the page's own hub a token becomes a cookie, which no script can read. At other hubs it is kept
 * until the page is closed.
 */
export class Login {
  /** null while it is unknown, or if the hub wants no token. */
  readonly who: Signal<Who | null>;
  readonly #who = new Source<Who | null>(null);
  readonly #hub: Hub;
  /** The address of the hub's pages, if the page is one of them. */
  readonly #site: URL | undefined;

  constructor(hub: Hub, page: string = location.href) {
    this.who = this.#who;
    this.#hub = hub;
    this.#site = siteOf(hub.url, page);
  }

  /** Ask the hub who the page is, and show the form at once if it is nobody. */
  async identify(): Promise<void> {
    const who = this.#site && (await ask(new URL("login", this.#site)));
    if (!who?.required) return;
    this.#who.set(who);
    if (who.name === null) this.#hub.deny(who.reason);
  }

  /** Log in; return why that fails, or an empty text. */
  async logIn(token: string): Promise<string> {
    if (!/^[\x21-\x7e]+$/.test(token)) return "a token has no spaces and no special characters";
    if (this.#site === undefined) {
      this.#hub.enter(token);
      return "";
    }
    const why = await requestCookie(new URL("login", this.#site), token);
    if (why !== "") return why;
    this.#hub.connect();
    await this.identify();
    return "";
  }

  /** Forget the token, and connect without it. */
  async logOut(): Promise<void> {
    if (this.#site === undefined) return;
    await fetch(new URL("logout", this.#site), OPTIONS);
    await this.identify();
    // Others are disconnected; who may be anonymous connects as that.
    if (this.#who.value?.name) this.#hub.connect();
  }
}

/** A browser names the page's origin to its own server only in the referrer. */
const OPTIONS: RequestInit = { referrerPolicy: "origin", cache: "no-store" };

/** The address of a hub's pages if this page is one of them: only these get cookies. */
export function siteOf(hub: string, page: string): URL | undefined {
  const url = new URL(hub);
  url.protocol = url.protocol.replace("ws", "http");
  url.search = "";
  return url.origin === new URL(page).origin ? url : undefined;
}

async function ask(url: URL): Promise<Who | undefined> {
  try {
    const response = await fetch(url, OPTIONS);
    const answer: unknown = await response.json();
    return response.ok && isWho(answer) ? answer : undefined;
  } catch {
    return undefined;
  }
}

function isWho(value: unknown): value is Who {
  return typeof value === "object" && value !== null && "required" in value && "name" in value;
}

async function requestCookie(url: URL, token: string): Promise<string> {
  try {
    const headers = { Authorization: `Bearer ${token}` };
    const response = await fetch(url, { ...OPTIONS, headers });
    if (response.ok) return "";
    const text = (await response.text()).trim().replace(/\.$/, "");
    return text || `the hub answers with status ${response.status}`;
  } catch {
    return "the hub does not answer";
  }
}
