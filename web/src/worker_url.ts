// The one address from which the page starts a worker, as the policy of Trusted Types wants it.

import address from "./graph/layout.worker.ts?worker&url";

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
    if (url !== address) throw new TypeError(`no script of this page's is at ${url}`);
    return url;
  },
});

export const layoutWorker: URL | string = policy?.createScriptURL(address) ?? address;
