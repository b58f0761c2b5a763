/** The addresses from which the page loads further scripts, as its Trusted Types policy wants. */
import workerUrl from "./graph/layout.worker.ts?worker&url";

/** In the same folder as the page. */
const ROSLIB_URL = "roslib.js";

interface TrustedTypes {
  createPolicy(
    name: string,
    rules: { createScriptURL(url: string): string },
  ): {
    createScriptURL(url: string): URL;
  };
}

const { trustedTypes } = globalThis as { trustedTypes?: TrustedTypes };

const policy = trustedTypes?.createPolicy("fibws", {
  createScriptURL(url) {
    if (url !== workerUrl && url !== ROSLIB_URL) throw new TypeError(`untrusted script: ${url}`);
    return url;
  },
});

export const layoutWorker: URL | string = policy?.createScriptURL(workerUrl) ?? workerUrl;

export const roslibScript: URL | string = policy?.createScriptURL(ROSLIB_URL) ?? ROSLIB_URL;
