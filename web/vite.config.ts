import { build, defineConfig, type Plugin } from "vite";

/** The files that roslib is served as: a plain script, and a module for `import`. */
const ROSLIB_FILES = { "roslib.js": "iife", "roslib.mjs": "es" } as const;

/** roslib in one file, for this page and for those of others. */
async function bundleRoslib(format: "iife" | "es"): Promise<string> {
  const output = await build({
    configFile: false,
    logLevel: "warn",
    plugins: [withoutWs],
    build: {
      write: false,
      target: "es2022",
      lib: { entry: "src/roslib.ts", name: "ROSLIB", formats: [format] },
      rolldownOptions: { output: { codeSplitting: false } },
    },
  });
  if (!Array.isArray(output) || !output[0]) throw new Error("roslib was not built");
  return output[0].output[0].code;
}

/** The WebSockets of Node are not for browsers, which have their own. */
const withoutWs: Plugin = {
  name: "without-ws",
  enforce: "pre",
  resolveId: (source) => (/^ws$|\/WsWebSocketTransport/.test(source) ? "\0without-ws" : null),
  load: (id) => (id === "\0without-ws" ? "export {}" : null),
};

/** Bags are read without parsing their messages, by code that the page's policy would forbid. */
const withoutParser: Plugin = {
  name: "without-parser",
  enforce: "pre",
  resolveId: (source) =>
    /^@foxglove\/rosmsg(-serialization)?$/.test(source) ? "\0without-parser" : null,
  load: (id) =>
    id === "\0without-parser" ? "export const parse = null; export class MessageReader {}" : null,
};

/** `/roslib.js` and `/roslib.mjs`, beside the page in the build and from memory while one develops. */
const roslib: Plugin = {
  name: "roslib",
  async generateBundle() {
    for (const [fileName, format] of Object.entries(ROSLIB_FILES)) {
      this.emitFile({ type: "asset", fileName, source: await bundleRoslib(format) });
    }
  },
  configureServer(server) {
    for (const [fileName, format] of Object.entries(ROSLIB_FILES)) {
      let code: Promise<string> | undefined;
      server.middlewares.use(`/${fileName}`, (_request, response) => {
        code ??= bundleRoslib(format);
        void code.then((text) => {
          response.setHeader("Content-Type", "text/javascript");
          response.end(text);
        });
      });
    }
  },
};

interface Zlib {
  brotliCompressSync(content: Uint8Array): Uint8Array<ArrayBuffer>;
  gzipSync(content: Uint8Array, options: { level: number }): Uint8Array<ArrayBuffer>;
}

/**
 * Puts each file's content in brotli and in gzip beside it, for the hub to send.
 *
 * Says how much a browser has to fetch, for which the tests have a limit.
 */
const pack: Plugin = {
  name: "pack",
  apply: "build",
  enforce: "post",
  generateBundle: {
    order: "post",
    async handler(_options, bundle) {
      // The types of Node's modules are no dependency.
      const zlib = (await import(`node:${"zlib"}`)) as Zlib;
      const totals = { br: 0, gz: 0 };
      for (const [fileName, file] of Object.entries(bundle)) {
        const source = file.type === "chunk" ? file.code : file.source;
        const content = typeof source === "string" ? new TextEncoder().encode(source) : source;
        const packed = {
          br: zlib.brotliCompressSync(content),
          gz: zlib.gzipSync(content, { level: 9 }),
        };
        for (const coding of ["br", "gz"] as const) {
          totals[coding] += Math.min(content.length, packed[coding].length);
          if (packed[coding].length >= content.length) continue;
          const name = `${fileName}.${coding}`;
          this.emitFile({ type: "asset", fileName: name, source: packed[coding] });
        }
      }
      const [br, gz] = [totals.br, totals.gz].map((each) => (each / 1024).toFixed(1));
      this.info(`${gz} KiB in all by gzip, ${br} KiB by brotli`);
    },
  },
};

export default defineConfig({
  base: "./",
  plugins: [roslib, pack],
  build: {
    target: "es2022",
    outDir: "../fibws/hub/page",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: {
      polyfill: false,
      // What is loaded later is a list of names in each file otherwise, to save a round trip.
      resolveDependencies: (_file, names, { hostId }) =>
        /\bindex\b/.test(hostId) ? names : names.filter((name) => name.endsWith(".css")),
    },
  },
  worker: { format: "es", plugins: () => [withoutParser] },
});
