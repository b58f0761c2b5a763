/** Opens a recording in the worker, and shows it as a hub shows what comes. */
import type { Delivery, Messages, Subscriber } from "../messages/feed";
import { Inbox } from "../messages/inbox";
import { Player, type Taker } from "../messages/player";
import type { Origin, RecordingReport } from "../messages/recording_messages";
import type { ClockReport } from "../messages/worker_messages";
import { JoinedRecording, filesOf as namedFiles } from "./joined";
import { CountedRanges, FileRanges, openUrl, type Ranges } from "./ranges";
import type { Recording } from "./recording";

const BAG = "#ROSBAG V2.0\n";
const MCAP = "\x89MCAP0\r\n";
/** In a folder of rosbag2: what is said of its files, and these. */
const METADATA = "metadata.yaml";
const RECORDING = /\.(bag|mcap)$/;

export class RecordedMessages implements Messages {
  readonly player: Player;
  readonly #takers = new Set<Taker>();
  readonly #topics: ReadonlySet<string>;

  constructor(recording: Recording, post: (report: ClockReport) => void) {
    this.#topics = new Set(recording.topics.map(({ name }) => name));
    this.player = new Player(recording, false, () => this.#takers, post);
  }

  subscribe(subscriber: Subscriber): () => void {
    const { topic, queue, throttle } = subscriber;
    const inbox = new Inbox<Delivery>(
      queue,
      throttle,
      (delivery) => subscriber.receive(delivery),
      (why) => subscriber.fail(why),
    );
    const taker = { subscriber, inbox };
    this.#takers.add(taker);
    subscriber.ready?.();
    if (this.#topics.has(topic)) this.player.add(taker);
    return () => {
      this.#takers.delete(taker);
      inbox.close();
    };
  }
}

/** Open a recording; the page gets a report, and another one with each new warning. */
export async function openRecording(
  origin: Origin,
  post: (report: RecordingReport | ClockReport) => void,
): Promise<RecordedMessages> {
  const none = { kind: "recording", size: 0, topics: [], warnings: [] } as const;
  const name = "url" in origin ? origin.url : origin.name;
  try {
    const { files, warnings: before } = await filesOf(origin);
    const size = files.reduce((sum, each) => sum + each.size, 0);
    const report = (): void => {
      const { topics, warnings } = recording;
      post({ kind: "recording", name, size, topics, warnings: [...warnings], fault: "" });
    };
    const parts: Recording[] = [];
    for (const each of files)
      parts.push(await recordingOf(new CountedRanges(each), () => report()));
    const [only] = parts;
    const isOne = only !== undefined && parts.length === 1 && before.length === 0;
    const recording = isOne ? only : new JoinedRecording(parts, before);
    report();
    return new RecordedMessages(recording, post);
  } catch (error) {
    post({ ...none, name, fault: (error as Error).message });
    throw error;
  }
}

/** The files of a recording, and what is wrong with them together. */
async function filesOf(origin: Origin): Promise<{ files: Ranges[]; warnings: string[] }> {
  if ("url" in origin) return { files: [await openUrl(origin.url, origin.token)], warnings: [] };
  const { files } = origin;
  const metadata = files.find(({ name }) => name === METADATA);
  const recordings = files.filter(({ name }) => RECORDING.test(name));
  const named = metadata === undefined ? [] : namedFiles(await metadata.text());
  const others = named.filter((name) => !recordings.some((file) => file.name === name));
  if (named.length > 0 && others.length === named.length)
    throw new Error(
      `${others.join(", ")} cannot be shown: expected MCAP files; fibws bag filter converts them`,
    );
  // A single file may have any name.
  const found = recordings.length > 0 ? recordings : files;
  if (found.length === 0) throw new Error(`${origin.name} has no recording: expected MCAP files`);
  return {
    files: found.map((file) => new FileRanges(file, file.name)),
    warnings: others.map((name) => `${name} is missing, or no MCAP file`),
  };
}

async function recordingOf(ranges: CountedRanges, warn: () => void): Promise<Recording> {
  const start = new TextDecoder("latin1").decode(await ranges.read(0, BAG.length));
  if (start === BAG) return (await import("./bag")).openBag(ranges, warn);
  // Latin-1 of browsers has other letters from 0x80 to 0x9f.
  if (start.slice(1).startsWith(MCAP.slice(1)))
    return (await import("./mcap")).openMcap(ranges, warn);
  throw new Error(`${ranges.name} is neither an MCAP file nor a bag of ROS 1 (version 2.0)`);
}
