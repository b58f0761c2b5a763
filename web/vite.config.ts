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

/** Says how much a browser has to fetch, for which the tests have a limit. */
const size: Plugin = {
  name: "size",
  apply: "build",
  async writeBundle(_options, bundle) {
    let total = 0;
    for (const file of Object.values(bundle)) {
      const content = file.type === "chunk" ? file.code : file.source;
      const bytes = new Blob([typeof content === "string" ? content : new Uint8Array(content)]);
      const zipped = new Response(bytes.stream().pipeThrough(new CompressionStream("gzip")));
      total += (await zipped.arrayBuffer()).byteLength;
    }
    this.info(`${(total / 1024).toFixed(1)} KiB gzipped in all`);
  },
};

export default defineConfig({
  base: "./",
  plugins: [roslib, size],
  build: {
    target: "es2022",
    outDir: "../fibws/hub/page",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
  worker: { format: "es" },
});
