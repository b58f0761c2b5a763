/** Where a browser downloads what a hub has recorded. */
import { siteOf } from "../login";

/**
 * The address of a recording's file.
 *
 * A token is in no address: the page's own hub knows its browser by the cookie of the login.
 *
 * @param file - the file's path on the hub's machine
 * @param hub - the hub's WebSocket address
 * @param page - the page's address
 */
export function downloadUrl(file: string, hub: string, page: string): string {
  const path = `recordings/${encodeURIComponent(nameOf(file))}`;
  const site = siteOf(hub, page);
  if (site !== undefined) return new URL(path, site).href;
  const other = new URL(hub);
  other.protocol = other.protocol.replace("ws", "http");
  other.search = "";
  other.pathname = `${other.pathname.replace(/\/?$/, "/")}${path}`;
  return other.href;
}

/** The name of a file, without its folder. */
export function nameOf(file: string): string {
  return file.slice(Math.max(file.lastIndexOf("/"), file.lastIndexOf("\\")) + 1);
}
