/** Files that are read in parts: those of the browser, and those of a server. */

export interface Ranges {
  readonly name: string;
  readonly size: number;
  /** Read some bytes; fewer at the end of the file. */
  read(offset: number, length: number): Promise<Uint8Array>;
}

/** Counts the bytes that are read. */
export class CountedRanges implements Ranges {
  readonly name: string;
  readonly size: number;
  total = 0;
  readonly #ranges: Ranges;

  constructor(ranges: Ranges) {
    this.name = ranges.name;
    this.size = ranges.size;
    this.#ranges = ranges;
  }

  read(offset: number, length: number): Promise<Uint8Array> {
    this.total += Math.max(0, Math.min(length, this.size - offset));
    return this.#ranges.read(offset, length);
  }
}

/** A server does not send what it should: the file itself may be good. */
export class Unreachable extends Error {}

/** Bytes of a file that a server does not send in parts. */
const MAX_WHOLE = 512 * 2 ** 20;

export class FileRanges implements Ranges {
  readonly name: string;
  readonly #blob: Blob;

  constructor(blob: Blob, name: string) {
    this.#blob = blob;
    this.name = name;
  }

  get size(): number {
    return this.#blob.size;
  }

  async read(offset: number, length: number): Promise<Uint8Array> {
    return new Uint8Array(await this.#blob.slice(offset, offset + length).arrayBuffer());
  }
}

class UrlRanges implements Ranges {
  readonly name: string;
  readonly size: number;
  readonly #url: string;
  readonly #token: string;

  constructor(url: string, token: string, name: string, size: number) {
    this.#url = url;
    this.#token = token;
    this.name = name;
    this.size = size;
  }

  async read(offset: number, length: number): Promise<Uint8Array> {
    if (length <= 0 || offset >= this.size) return new Uint8Array();
    const end = Math.min(offset + length, this.size) - 1;
    const response = await request(this.#url, this.#token, `bytes=${offset}-${end}`);
    if (response.status !== 206)
      throw new Unreachable(`the server sent the status ${response.status}`);
    return new Uint8Array(await response.arrayBuffer());
  }
}

/** Open a file at a URL; `token` goes to its server, if there is one. */
export async function openUrl(url: string, token = ""): Promise<Ranges> {
  const name = decodeURIComponent(new URL(url).pathname.split("/").at(-1) ?? "") || url;
  const response = await request(url, token, "bytes=0-0");
  if (!response.ok) {
    const why = (await response.text()).trim().slice(0, 200);
    throw new Error(`${name}: ${why || `the server sent the status ${response.status}`}`);
  }
  const size = Number(/\/(\d+)$/.exec(response.headers.get("Content-Range") ?? "")?.[1]);
  if (response.status === 206 && size > 0) {
    await response.body?.cancel();
    return new UrlRanges(url, token, name, size);
  }
  // This server sends files as a whole only.
  if (Number(response.headers.get("Content-Length")) > MAX_WHOLE) {
    await response.body?.cancel();
    throw new Error(`${name} is too large for a server that does not send parts of files`);
  }
  return new FileRanges(await response.blob(), name);
}

function request(url: string, token: string, range: string): Promise<Response> {
  const headers: Record<string, string> = { Range: range };
  if (token !== "") headers.Authorization = `Bearer ${token}`;
  return fetch(url, { headers }).catch((error: Error) => {
    throw new Unreachable(error.message);
  });
}
