/** Loads meshes by their URIs, in a worker, and draws them. */

import { siteOf } from "../../../login";
import { meshWorker } from "../../../script_urls";
import type { DataSource } from "../../../source";
import type { Transform, Vector } from "../../../transforms";
import type { Color } from "../colors";
import { renderer, Vertices } from "../renderer";
import { COLORED, type MeshData, PLAIN } from "./mesh";

export interface MeshRequest {
  readonly id: number;
  readonly url: string;
  readonly init: RequestInit;
}

export type MeshReport =
  | { readonly id: number; readonly mesh: MeshData }
  | { readonly id: number; readonly why: string };

const SCHEME = "package://";
/** What is drawn instead of a missing mesh. */
const MISSING: Color = [1, 0.2, 0.7, 1];
const MISSING_SIZE = 0.1;

/** The meshes being loaded, by their numbers; the worker is there while there are any. */
const waiting = new Map<number, (report: MeshReport) => void>();
let worker: Worker | undefined;
let last = 0;

function request(url: string, init: RequestInit): Promise<MeshData> {
  if (worker === undefined) {
    worker = new Worker(meshWorker, { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<MeshReport>) => waiting.get(data.id)?.(data);
    worker.onerror = ({ message }) => {
      const why = message || "the worker did not start";
      for (const [id, done] of [...waiting]) done({ id, why });
    };
  }
  last += 1;
  const id = last;
  worker.postMessage({ id, url, init } satisfies MeshRequest);
  return new Promise((resolve, reject) => {
    waiting.set(id, (report) => {
      waiting.delete(id);
      if (waiting.size === 0) {
        worker?.terminate();
        worker = undefined;
      }
      if ("mesh" in report) resolve(report.mesh);
      else reject(new Error(report.why));
    });
  });
}

/** Where a browser finds a file, and how it asks; throws an `Error` for addresses of others. */
export function addressOf(
  uri: string,
  hub: string,
  token: string,
  page: string,
): { url: string; init: RequestInit } {
  if (/^https?:/.test(uri)) return { url: uri, init: { credentials: "omit" } };
  if (!uri.startsWith(SCHEME)) {
    throw new Error(`a browser cannot open this address: expected ${SCHEME}PACKAGE/PATH`);
  }
  const parts = uri.slice(SCHEME.length).split("/");
  const path = parts.map((each) => encodeURIComponent(decoded(each))).join("/");
  const headers: Record<string, string> = token === "" ? {} : { Authorization: `Bearer ${token}` };
  const site = siteOf(hub, page);
  if (site !== undefined) {
    return { url: new URL(`assets/package/${path}`, site).href, init: { headers } };
  }
  const other = new URL(hub);
  other.protocol = other.protocol.replace("ws", "http");
  other.search = "";
  other.pathname = `${other.pathname.replace(/\/?$/, "/")}assets/package/${path}`;
  return { url: other.href, init: { headers, credentials: "omit" } };
}

function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

interface Loaded {
  readonly plain: Vertices;
  readonly colored: Vertices;
  /** Numbers of corners. */
  readonly counts: readonly [plain: number, colored: number];
}

/** The meshes of a layer. */
export class Meshes {
  /** Why meshes are missing, by their URIs. */
  readonly faults = new Map<string, string>();
  readonly #hub: DataSource;
  readonly #onChange: () => void;
  readonly #known = new Map<string, Loaded | undefined>();
  readonly #box = new Vertices();
  #isClosed = false;

  /** `onChange` is called when a mesh is there, or is known to be missing. */
  constructor(hub: DataSource, onChange: () => void) {
    this.#hub = hub;
    this.#onChange = onChange;
    this.#box.set(Float32Array.of(0, 0, 0, 0, 0, 0, 1, ...Array(3).fill(MISSING_SIZE), ...MISSING));
  }

  /** How many meshes are being loaded. */
  get loading(): number {
    return [...this.#known.values()].filter((each) => each === undefined).length - this.faults.size;
  }

  /** Draw a mesh once it is loaded, or else a pink box. `color` is that of parts without one. */
  draw(uri: string, model: Transform, scale: Vector, color: Color, hasOwnColors = true): void {
    if (!this.#known.has(uri)) this.#load(uri);
    const mesh = this.#known.get(uri);
    if (mesh === undefined) {
      if (this.faults.has(uri)) {
        renderer.solids({ shape: "box", vertices: this.#box, count: 1 }, model);
      }
      return;
    }
    const [plain, colored] = mesh.counts;
    if (plain > 0) {
      renderer.mesh({ vertices: mesh.plain, count: plain, color, scale }, model);
    }
    if (colored > 0) {
      const own: Color = hasOwnColors ? [1, 1, 1, color[3]] : color;
      renderer.mesh(
        { vertices: mesh.colored, count: colored, color: own, scale, hasColors: true },
        model,
      );
    }
  }

  async #load(uri: string): Promise<void> {
    this.#known.set(uri, undefined);
    try {
      const { token } = this.#hub.second();
      const { url, init } = addressOf(uri, this.#hub.url, token, location.href);
      const { plain, colored } = await request(url, init);
      if (this.#isClosed) return;
      this.#known.set(uri, {
        plain: new Vertices(plain),
        colored: new Vertices(colored),
        counts: [plain.length / PLAIN, colored.length / COLORED],
      });
    } catch (error) {
      this.faults.set(uri, (error as Error).message);
    }
    if (!this.#isClosed) this.#onChange();
  }

  /** Those of some URIs that are missing, in words; empty if none is. */
  faultOf(uris: ReadonlySet<string>): string {
    const missing = [...this.faults].filter(([uri]) => uris.has(uri));
    const [first] = missing;
    if (first === undefined) return "";
    const [uri, why] = first;
    const others = missing.length - 1;
    return `${uri}: ${why}${others > 0 ? ` (and ${others} more meshes)` : ""}`;
  }

  close(): void {
    this.#isClosed = true;
    this.#box.close();
    for (const mesh of this.#known.values()) {
      mesh?.plain.close();
      mesh?.colored.close();
    }
    this.#known.clear();
  }
}
