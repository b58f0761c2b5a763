/** Recordings in MCAP files: https://mcap.dev/spec */
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { History } from "../messages/history";
import type { Topic } from "../messages/recording_messages";
import type { Kept } from "../messages/store";
import { decompressors } from "./decompress";
import type { CountedRanges, Ranges } from "./ranges";
import { Channel, IndexedRecording, type Recording, topicsOf } from "./recording";

/** Bytes of message indexes that are kept. */
const INDEX_CACHE = 64 * 2 ** 20;
/** Bytes of a file without an index that are read at once, and of its messages that are kept. */
const PIECE = 4 * 2 ** 20;
const MAX_BYTES = 512 * 2 ** 20;
/** Compressions of MCAP. */
const COMPRESSIONS = ["lz4", "zstd"];
/** More than times lose by being rounded to ms, in ns. */
const ROUNDED = 1000n;

type ChannelRecord = { topic: string; schemaId: number; messageEncoding: string };
type SchemaRecord = { name: string; data: Uint8Array };

/** Open a file; without an index, it is read as a whole. */
export async function openMcap(ranges: CountedRanges, warn: () => void): Promise<Recording> {
  const readable = {
    size: async () => BigInt(ranges.size),
    read: (offset: bigint, length: bigint) => ranges.read(Number(offset), Number(length)),
  };
  try {
    const decompressHandlers: Awaited<ReturnType<typeof decompressors>> = {};
    const messageIndexCacheSizeBytes = INDEX_CACHE;
    const settings = { readable, decompressHandlers, messageIndexCacheSizeBytes };
    const reader = await McapIndexedReader.Initialize(settings);
    const names = reader.chunkIndexes.map(({ compression }) => compression);
    Object.assign(decompressHandlers, await decompressors(names));
    if (reader.chunkIndexes.length > 0) return new McapRecording(reader, ranges, warn);
    return await readWhole(ranges, []);
  } catch (error) {
    const why = `no index (${(error as Error).message}): the messages before the damage are shown`;
    return readWhole(ranges, [why]);
  }
}

class McapRecording extends IndexedRecording {
  readonly topics: readonly Topic[];
  readonly start: number;
  readonly end: number;
  readonly #reader: McapIndexedReader;
  readonly #channels = new Map<number, Channel>();

  constructor(reader: McapIndexedReader, ranges: CountedRanges, warn: () => void) {
    super(ranges, warn);
    this.#reader = reader;
    for (const [id, channel] of reader.channelsById)
      this.#channels.set(id, channelOf(channel, reader.schemasById.get(channel.schemaId)));
    this.topics = topicsOf(this.#channels.values());
    const filled = reader.chunkIndexes.filter(({ messageEndTime }) => messageEndTime > 0n);
    const times = (each: readonly bigint[]): number[] => each.map(ms);
    this.start = times(filled.map(({ messageStartTime }) => messageStartTime)).reduce(
      (least, each) => Math.min(least, each),
      Infinity,
    );
    this.end = times(filled.map(({ messageEndTime }) => messageEndTime)).reduce(
      (most, each) => Math.max(most, each),
      -Infinity,
    );
    if (this.start > this.end) [this.start, this.end] = [0, 0];
  }

  protected async *read(
    topics: readonly string[],
    from: number,
    to: number,
    isBack: boolean,
  ): AsyncGenerator<Kept> {
    const [startTime, endTime] = [ns(from) - ROUNDED, ns(to) + ROUNDED];
    const range = { topics, startTime, endTime, reverse: isBack };
    for await (const { channelId, logTime, data } of this.#reader.readMessages(range)) {
      const channel = this.#channels.get(channelId);
      if (channel !== undefined) yield channel.kept(ms(logTime), data);
    }
  }

  protected leaveOut(topics: readonly string[], time: number, isBack: boolean): boolean {
    const chunks = this.#reader.chunkIndexes as McapIndexedReader["chunkIndexes"][number][];
    const has = (id: number): boolean => topics.includes(this.#channels.get(id)?.topic.name ?? "");
    const [low, high] = [ns(time) - ROUNDED, ns(time) + ROUNDED];
    const rest = chunks
      .filter(({ messageIndexOffsets }) => [...messageIndexOffsets.keys()].some(has))
      .filter((each) => (isBack ? each.messageStartTime <= high : each.messageEndTime >= low))
      .sort((a, b) => Number(a.messageStartTime - b.messageStartTime));
    const damaged = isBack ? rest.at(-1) : rest[0];
    if (damaged === undefined) return false;
    chunks.splice(chunks.indexOf(damaged), 1);
    return true;
  }
}

/** Read all messages up to the first damage. */
async function readWhole(ranges: Ranges, warnings: string[]): Promise<Recording> {
  const history = new History(Infinity);
  const channels = new Map<number, Channel>();
  const schemas = new Map<number, SchemaRecord>();
  const handlers = await decompressors(COMPRESSIONS);
  const reader = new McapStreamReader({ decompressHandlers: handlers });
  const all: Kept[] = [];
  let size = 0;
  try {
    for (let offset = 0; offset < ranges.size && size < MAX_BYTES; offset += PIECE) {
      reader.append(await ranges.read(offset, PIECE));
      for (let record = reader.nextRecord(); record !== undefined; record = reader.nextRecord()) {
        if (record.type === "Schema") schemas.set(record.id, record);
        if (record.type === "Channel")
          channels.set(record.id, channelOf(record, schemas.get(record.schemaId)));
        if (record.type !== "Message") continue;
        const kept = channels.get(record.channelId)?.kept(ms(record.logTime), record.data.slice());
        if (kept !== undefined) all.push(kept);
        size += record.data.length;
      }
    }
    if (size >= MAX_BYTES) warnings.push("only the beginning is shown: there is no index");
  } catch (error) {
    warnings.push(`the rest is damaged: ${(error as Error).message}`);
  }
  for (const kept of all.sort((a, b) => a.time - b.time)) history.add(kept);
  const recording = { topics: topicsOf(channels.values()), warnings };
  return Object.assign(history, recording);
}

function channelOf(channel: ChannelRecord, schema: SchemaRecord | undefined): Channel {
  const definition = new TextDecoder().decode(schema?.data);
  return new Channel(channel.topic, schema?.name ?? "", definition, channel.messageEncoding);
}

function ms(time: bigint): number {
  return Number(time) / 1e6;
}

function ns(time: number): bigint {
  const found = BigInt(Math.round(time * 1e6));
  return found > ROUNDED ? found : ROUNDED;
}
