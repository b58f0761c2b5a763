/** Saves files that the page has made. */
import { h } from "./dom";

/** Ask the browser to save a file under a name. */
export function download(name: string, file: Blob): void {
  const href = URL.createObjectURL(file);
  h("a", { href, download: name }).click();
  // The browser may still read it.
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}
