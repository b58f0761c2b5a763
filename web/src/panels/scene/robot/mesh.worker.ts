/// <reference lib="webworker" />
// Fetches files of meshes, and makes triangles of them, off the main thread.

import { readDae } from "./dae";
import { type MeshData, readStl } from "./mesh";
import type { MeshReport, MeshRequest } from "./mesh_client";
import { materialFiles, readMtl, readObj } from "./obj";

declare const self: DedicatedWorkerGlobalScope;

/** The largest file, which is that of the hub. */
const MAX_BYTES = 64 * 2 ** 20;
/** How often a hub is asked again that is busy with other files, and after which time in ms. */
const [TRIES, WAIT] = [20, 1000];

self.onmessage = async ({ data }: MessageEvent<MeshRequest>): Promise<void> => {
  const { id } = data;
  try {
    const mesh = await load(data);
    const report: MeshReport = { id, mesh };
    self.postMessage(report, [mesh.plain.buffer, mesh.colored.buffer]);
  } catch (error) {
    const report: MeshReport = { id, why: (error as Error).message };
    self.postMessage(report);
  }
};

async function load({ url, init }: MeshRequest): Promise<MeshData> {
  const [, kind = ""] = /\.([a-z]+)$/i.exec(new URL(url).pathname) ?? [];
  switch (kind.toLowerCase()) {
    case "stl":
      return readStl(await fetched(url, init));
    case "dae":
      return readDae(decoded(await fetched(url, init)));
    case "obj": {
      const text = decoded(await fetched(url, init));
      const colors = new Map(
        (await Promise.all(materialFiles(text).map((name) => materials(url, name, init)))).flat(),
      );
      return readObj(text, colors);
    }
    default:
      throw new Error(`files in .${kind} are not drawn, only in .stl, .dae and .obj`);
  }
}

/** The colours in a file beside that of a mesh; none if it is missing or invalid. */
async function materials(url: string, name: string, init: RequestInit) {
  const beside = new URL(name, url);
  beside.search = new URL(url).search;
  try {
    return [...readMtl(decoded(await fetched(beside.href, init)))];
  } catch (error) {
    console.debug(error);
    return [];
  }
}

function decoded(bytes: Uint8Array): string {
  return new TextDecoder().decode(bytes);
}

async function fetched(url: string, init: RequestInit): Promise<Uint8Array> {
  for (let left = TRIES; ; left -= 1) {
    const response = await fetch(url, init);
    if (response.status === 503 && left > 0) {
      await new Promise((resolve) => setTimeout(resolve, WAIT));
      continue;
    }
    if (!response.ok) throw new Error(await reasonOf(response));
    const bytes = new Uint8Array(await response.arrayBuffer());
    if (bytes.length > MAX_BYTES) {
      throw new Error(`the file is too large: ${bytes.length} bytes (limit ${MAX_BYTES})`);
    }
    return bytes;
  }
}

/** Why the hub has refused a file. */
async function reasonOf(response: Response): Promise<string> {
  try {
    const { reason } = (await response.json()) as { reason?: unknown };
    if (typeof reason === "string") return reason;
  } catch {
    // Another server may be there, or an older hub.
  }
  return `the hub answers with status ${response.status}`;
}
