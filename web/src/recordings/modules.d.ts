/** Types of packages that have none. */
declare module "lz4js" {
  /** Decompress a frame; returns the number of bytes. */
  export function decompressFrame(bytes: Uint8Array, into: Uint8Array): number;
}

declare module "bz2" {
  const bz2: { decompress(bytes: Uint8Array, checkCRC?: boolean): Uint8Array };
  export default bz2;
}
