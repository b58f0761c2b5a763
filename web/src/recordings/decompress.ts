/** Decompresses chunks of recordings; the code is loaded for what a file has. */

/** Decompress bytes; `size` is how many there are then. */
export type Decompress = (bytes: Uint8Array, size: number | bigint) => Uint8Array;

const LOADERS: Readonly<Record<string, () => Promise<Decompress>>> = {
  lz4: async () => {
    const { decompressFrame } = await import("lz4js");
    return (bytes, size) => {
      const into = new Uint8Array(Number(size));
      const length = decompressFrame(bytes, into);
      if (length !== into.length) throw new Error(`lz4 has ${length} bytes, ${size} expected`);
      return into;
    };
  },
  zstd: async () => {
    const { decompress } = await import("fzstd");
    return (bytes, size) => {
      const into = decompress(bytes, new Uint8Array(Number(size)));
      if (into.length !== Number(size))
        throw new Error(`zstd has ${into.length} bytes, ${size} expected`);
      return into;
    };
  },
  bz2: async () => {
    const { default: bz2 } = await import("bz2");
    return (bytes) => bz2.decompress(bytes);
  },
};

/** What decompresses, for each of these compressions that is known. */
export async function decompressors(
  compressions: Iterable<string>,
): Promise<Record<string, Decompress>> {
  const names = [...new Set(compressions)].filter((name) => Object.hasOwn(LOADERS, name));
  const loaded = names.map(async (name) => [name, await LOADERS[name]?.()] as const);
  return Object.fromEntries(await Promise.all(loaded)) as Record<string, Decompress>;
}
