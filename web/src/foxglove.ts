/** Links that open a hub in Foxglove and in Lichtblick, which speak a protocol that hubs speak. */

import "./foxglove.css";

import { h } from "./dom";

export const FOXGLOVE = "https://app.foxglove.dev/~/view";
export const LICHTBLICK = "https://lichtblick-suite.github.io/lichtblick/";

/** The address of an application that is to connect to the hub at a WebSocket address. */
export function applicationUrl(application: string, hub: string): string {
  const url = new URL(application);
  url.searchParams.set("ds", "foxglove-websocket");
  url.searchParams.set("ds.url", hub);
  return url.href;
}

/** A link that opens a hub in an application, in another tab. */
export function applicationLink(application: string, hub: string, name: string): HTMLElement {
  return h(
    "a",
    {
      href: applicationUrl(application, hub),
      target: "_blank",
      // The application need not know the page's address, in which there may be names.
      rel: "noopener noreferrer",
      title: `Open this hub in ${name}. The hub needs --allow-origin ${new URL(application).origin}`,
    },
    name,
  );
}
