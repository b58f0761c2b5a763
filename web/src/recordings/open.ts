/** Opens a recording in the worker, and shows it as a hub shows what comes. */
import type { Delivery, Messages, Subscriber } from "../messages/feed";
import { Inbox } from "../messages/inbox";
import { Player, type Taker } from "../messages/player";
import type { Origin, RecordingReport } from "../messages/recording_messages";
import type { ClockReport } from "../messages/worker_messages";
import { CountedRanges, FileRanges, openUrl, type Ranges } from "./ranges";
import type { Recording } from "./recording";

const BAG = "#ROSBAG V2.0\n";
const MCAP = "\x89MCAP0\r\n";

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
  try {
    const ranges = new CountedRanges(await rangesOf(origin));
    const { name, size } = ranges;
    const report = (): void => {
      const { topics, warnings } = recording;
      post({ kind: "recording", name, size, topics, warnings: [...warnings], fault: "" });
    };
    const recording = await recordingOf(ranges, () => report());
    report();
    return new RecordedMessages(recording, post);
  } catch (error) {
    const name = origin instanceof File ? origin.name : origin.url;
    post({ ...none, name, fault: (error as Error).message });
    throw error;
  }
}

async function rangesOf(origin: Origin): Promise<Ranges> {
  if (origin instanceof File) return new FileRanges(origin, origin.name);
  return openUrl(origin.url, origin.token);
}

async function recordingOf(ranges: CountedRanges, warn: () => void): Promise<Recording> {
  const start = new TextDecoder("latin1").decode(await ranges.read(0, BAG.length));
  if (start === BAG) return (await import("./bag")).openBag(ranges, warn);
  // Latin-1 of browsers has other letters from 0x80 to 0x9f.
  if (start.slice(1).startsWith(MCAP.slice(1)))
    return (await import("./mcap")).openMcap(ranges, warn);
  throw new Error(`${ranges.name} is neither an MCAP file nor a bag of ROS 1 (version 2.0)`);
}
