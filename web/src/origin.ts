/** Asks a hub whether this page may connect: a browser does not say why a WebSocket failed. */

/** The hub's answer at `/origin`: whether the page that asks may connect. */
export interface OriginAnswer {
  /** The page's origin; null if the browser did not name it. */
  origin: string | null;
  allowed: boolean;
  reason: string;
  /** The option of the hub that lets the page in; empty if it may connect. */
  option: string;
}

/** The address of the hub's answer; `hub` is its WebSocket address. */
export function originUrl(hub: string): string {
  const url = new URL(hub);
  url.protocol = url.protocol.replace("ws", "http");
  return new URL("origin", url).href;
}

/** Ask a hub whether this page may connect; undefined if it does not answer. */
export async function askHub(hub: string): Promise<OriginAnswer | undefined> {
  try {
    // A browser names the origin of a page to its own server only in the referrer.
    const response = await fetch(originUrl(hub), { referrerPolicy: "origin", cache: "no-store" });
    const answer: unknown = await response.json();
    return response.ok && isAnswer(answer) ? answer : undefined;
  } catch {
    return undefined;
  }
}

function isAnswer(value: unknown): value is OriginAnswer {
  return typeof value === "object" && value !== null && "allowed" in value && "option" in value;
}
