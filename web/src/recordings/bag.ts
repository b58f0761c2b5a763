/** Recordings in .bag files of ROS 1: http://wiki.ros.org/Bags/Format/2.0 */
import { Bag } from "@foxglove/rosbag";
import { History } from "../messages/history";
import type { Topic } from "../messages/recording_messages";
import type { Kept } from "../messages/store";
import { type Decompress, decompressors } from "./decompress";
import type { CountedRanges, Ranges } from "./ranges";
import { Channel, IndexedRecording, type Recording, topicsOf } from "./recording";

interface Time {
  readonly sec: number;
  readonly nsec: number;
}

/** The length of the first line of a bag. */
const MAGIC = 13;
/** Bytes of a bag without an index that are read at most. */
const MAX_BYTES = 512 * 2 ** 20;
/** Bytes of a header; larger ones are damage. */
const MAX_HEADER = 2 ** 20;
/** Bytes in which the first chunk says its compression. */
const HEAD = 4096;
const [MESSAGE, CHUNK, CONNECTION] = [2, 5, 7];
/** Compressions of bags. */
const COMPRESSIONS = ["lz4", "bz2"];

/** Open a file; without an index, it is read as a whole. */
export async function openBag(ranges: CountedRanges, warn: () => void): Promise<Recording> {
  const decompress: Record<string, Decompress> = {};
  const file = {
    size: () => ranges.size,
    read: (offset: number, length: number) => ranges.read(offset, length),
  };
  try {
    const bag = new Bag(file, { parse: false, decompress });
    await bag.open();
    const [first] = bag.chunkInfos;
    if (first === undefined) throw new Error("it has no chunks");
    Object.assign(
      decompress,
      await decompressors(await compressionOf(ranges, first.chunkPosition)),
    );
    return new BagRecording(bag, ranges, warn);
  } catch (error) {
    const why = `no index (${(error as Error).message}): the messages before the damage are shown`;
    return readWhole(ranges, why);
  }
}

/** What the first chunk says of its compression: all are of one, unless somebody joined bags. */
async function compressionOf(ranges: Ranges, at: number): Promise<string[]> {
  const head = new TextDecoder("latin1").decode(await ranges.read(at, HEAD));
  const name = /compression=([a-z0-9]+)/.exec(head)?.[1] ?? "none";
  return name === "none" ? [] : COMPRESSIONS;
}

class BagRecording extends IndexedRecording {
  readonly topics: readonly Topic[];
  readonly start: number;
  readonly end: number;
  readonly #bag: Bag;
  readonly #channels = new Map<number, Channel>();
  readonly #nodes = new Map<number, string>();

  constructor(bag: Bag, ranges: CountedRanges, warn: () => void) {
    super(ranges, warn);
    this.#bag = bag;
    for (const [id, { topic, type = "", messageDefinition, callerid = "" }] of bag.connections) {
      this.#channels.set(id, new Channel(topic, type, messageDefinition, "ros1"));
      this.#nodes.set(id, callerid);
    }
    this.topics = topicsOf(this.#channels.values());
    this.start = bag.chunkInfos.reduce(
      (least, { startTime }) => Math.min(least, ms(startTime)),
      Infinity,
    );
    this.end = bag.chunkInfos.reduce((most, { endTime }) => Math.max(most, ms(endTime)), -Infinity);
  }

  protected async *read(
    topics: readonly string[],
    from: number,
    to: number,
    isBack: boolean,
  ): AsyncGenerator<Kept> {
    const start = timeOf(isBack ? to : from, isBack ? 1000 : -1000);
    const messages = this.#bag.messageIterator({ topics: [...topics], start, reverse: isBack });
    for await (const { connectionId, timestamp, data } of messages) {
      const time = ms(timestamp);
      if (isBack ? time < from : time > to) return;
      const kept = this.#channels
        .get(connectionId)
        ?.kept(time, data, this.#nodes.get(connectionId));
      if (kept !== undefined) yield kept;
    }
  }

  protected leaveOut(topics: readonly string[], time: number, isBack: boolean): boolean {
    const has = (id: number): boolean => topics.includes(this.#channels.get(id)?.topic.name ?? "");
    const rest = this.#bag.chunkInfos
      .filter(({ connections }) => connections.some(({ conn }) => has(conn)))
      .filter((each) => (isBack ? ms(each.startTime) <= time : ms(each.endTime) >= time))
      .sort((a, b) => ms(a.startTime) - ms(b.startTime));
    const damaged = isBack ? rest.at(-1) : rest[0];
    if (damaged === undefined) return false;
    this.#bag.chunkInfos = this.#bag.chunkInfos.filter((each) => each !== damaged);
    return true;
  }
}

/** A record of a bag: its fields, and what follows them. */
interface BagRecord {
  readonly op: number;
  readonly fields: ReadonlyMap<string, Uint8Array>;
  readonly data: Uint8Array;
  readonly size: number;
}

/** Read all messages up to the first damage. */
async function readWhole(ranges: Ranges, why: string): Promise<Recording> {
  const bytes = await ranges.read(0, Math.min(ranges.size, MAX_BYTES));
  const decompress = await decompressors(COMPRESSIONS);
  const warnings = [why];
  const channels = new Map<number, Channel>();
  const all: Kept[] = [];
  const take = (from: Uint8Array): void => {
    for (let at = 0; at < from.length; ) {
      const record = recordAt(from, at);
      at += record.size;
      const { op, fields, data } = record;
      if (op === CHUNK) take(unpacked(record, decompress));
      if (op === CONNECTION) {
        const header = fieldsOf(data);
        const text = (name: string): string => new TextDecoder().decode(header.get(name));
        const topic = new TextDecoder().decode(fields.get("topic"));
        const channel = new Channel(topic, text("type"), text("message_definition"), "ros1");
        channels.set(numberOf(fields, "conn"), channel);
      }
      if (op === MESSAGE) {
        const time = { sec: numberOf(fields, "time"), nsec: numberOf(fields, "time", 4) };
        const kept = channels.get(numberOf(fields, "conn"))?.kept(ms(time), data.slice());
        if (kept !== undefined) all.push(kept);
      }
    }
  };
  try {
    take(bytes.subarray(MAGIC));
  } catch (error) {
    warnings.push(`the rest is damaged: ${(error as Error).message}`);
  }
  if (ranges.size > MAX_BYTES) warnings.push("only the beginning is shown: there is no index");
  const history = new History(Infinity);
  for (const kept of all.sort((a, b) => a.time - b.time)) history.add(kept);
  return Object.assign(history, { topics: topicsOf(channels.values()), warnings });
}

function unpacked({ fields, data }: BagRecord, decompress: Record<string, Decompress>): Uint8Array {
  const name = new TextDecoder().decode(fields.get("compression"));
  if (name === "none") return data;
  const unpack = decompress[name];
  if (unpack === undefined) throw new Error(`unknown compression ${name}`);
  return unpack(data, numberOf(fields, "size"));
}

function recordAt(bytes: Uint8Array, at: number): BagRecord {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const end = (start: number, most: number): number => {
    const size = start + 4 <= bytes.length ? view.getUint32(start, true) : Infinity;
    if (size > most || start + 4 + size > bytes.length) throw new Error(`it ends at byte ${at}`);
    return start + 4 + size;
  };
  const header = end(at, MAX_HEADER);
  const last = end(header, Infinity);
  const fields = fieldsOf(bytes.subarray(at + 4, header));
  const op = fields.get("op")?.[0] ?? 0;
  return { op, fields, data: bytes.subarray(header + 4, last), size: last - at };
}

/** Fields such as `op=…`, each after its length. */
function fieldsOf(bytes: Uint8Array): Map<string, Uint8Array> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const fields = new Map<string, Uint8Array>();
  for (let at = 0; at + 4 <= bytes.length; ) {
    const end = at + 4 + view.getUint32(at, true);
    const field = bytes.subarray(at + 4, end);
    const sign = field.indexOf(0x3d);
    fields.set(new TextDecoder().decode(field.subarray(0, sign)), field.subarray(sign + 1));
    at = end;
  }
  return fields;
}

function numberOf(fields: ReadonlyMap<string, Uint8Array>, name: string, at = 0): number {
  const bytes = fields.get(name);
  if (bytes === undefined) throw new Error(`a record has no ${name}`);
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength).getUint32(at, true);
}

function ms({ sec, nsec }: Time): number {
  // As from one number of ns, so that times of equal messages are equal.
  return Number(BigInt(sec) * 1_000_000_000n + BigInt(nsec)) / 1e6;
}

/** A time some ns later. */
function timeOf(time: number, later: number): Time {
  const ns = BigInt(Math.max(0, Math.round(time * 1e6) + later));
  return { sec: Number(ns / 1_000_000_000n), nsec: Number(ns % 1_000_000_000n) };
}
