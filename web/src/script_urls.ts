/** The addresses from which the page loads further scripts, as its Trusted Types policy wants. */

import dataUrl from "./data.worker.ts?worker&url";
import layoutUrl from "./graph/layout.worker.ts?worker&url";
import meshUrl from "./panels/scene/robot/mesh.worker.ts?worker&url";

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

const TRUSTED = [layoutUrl, dataUrl, meshUrl, ROSLIB_URL];

const policy = trustedTypes?.createPolicy("fibws", {
  createScriptURL(url) {
    if (!TRUSTED.includes(url)) throw new TypeError(`untrusted script: ${url}`);
    return url;
  },
});

export const layoutWorker = trusted(layoutUrl);

export const dataWorker = trusted(dataUrl);

export const meshWorker = trusted(meshUrl);

export const roslibScript = trusted(ROSLIB_URL);

function trusted(url: string): URL | string {
  return policy?.createScriptURL(url) ?? url;
}
