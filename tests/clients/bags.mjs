/** Prints the messages of bags as JSON, one bag a line: node bags.mjs BAG... */

import { readFile } from "node:fs/promises";

import { Bag } from "@foxglove/rosbag";
import { FileReader } from "@foxglove/rosbag/node.js";
import Bzip2 from "@foxglove/wasm-bz2";
import lz4 from "@foxglove/wasm-lz4";
import zstd from "@foxglove/wasm-zstd";
import { McapIndexedReader } from "@mcap/core";

await Promise.all([lz4.isLoaded, zstd.isLoaded]);
const bzip2 = await Bzip2.init();
const hex = (data) => Buffer.from(data).toString("hex");

async function rosbag(path) {
  const decompress = {
    bz2: (data, size) => bzip2.decompress(data, size, { small: false }),
    lz4: (data, size) => lz4(data, size),
  };
  const bag = new Bag(new FileReader(path), { decompress, parse: true });
  await bag.open();
  const messages = [];
  for await (const { connectionId, data, timestamp } of bag.messageIterator()) {
    const { topic, type, md5sum, callerid, latching } = bag.connections.get(connectionId);
    const time = String(BigInt(timestamp.sec) * 1_000_000_000n + BigInt(timestamp.nsec));
    messages.push([topic, type, md5sum, callerid ?? "", latching ?? false, time, hex(data)]);
  }
  return messages;
}

async function mcap(path) {
  const content = await readFile(path);
  const readable = {
    size: async () => BigInt(content.byteLength),
    read: async (offset, size) =>
      new Uint8Array(content.subarray(Number(offset), Number(offset + size))),
  };
  const decompressHandlers = {
    lz4: (data, size) => lz4(data, Number(size)),
    zstd: (data, size) => zstd.decompress(data, Number(size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = [];
  for await (const { channelId, data, logTime } of reader.readMessages()) {
    const { metadata, messageEncoding, schemaId, topic } = reader.channelsById.get(channelId);
    const { encoding, name } = reader.schemasById.get(schemaId);
    if (messageEncoding !== "ros1" || encoding !== "ros1msg") {
      throw new Error(`${topic}: ${messageEncoding}, ${encoding}`);
    }
    const [md5sum, callerid] = [metadata.get("md5sum"), metadata.get("callerid") ?? ""];
    const latching = metadata.get("latching") === "1";
    messages.push([topic, name, md5sum, callerid, latching, String(logTime), hex(data)]);
  }
  return messages;
}

for (const path of process.argv.slice(2)) {
  console.log(JSON.stringify(await (path.endsWith(".mcap") ? mcap : rosbag)(path)));
}
