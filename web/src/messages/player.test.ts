import { afterEach, beforeEach, expect, it, vi } from "vitest";
import type { Playback } from "../clock";
import type { Delivery } from "./feed";
import { History } from "./history";
import { Inbox } from "./inbox";
import { Player, type Taker } from "./player";

const START = 1_000_000;

beforeEach(() => vi.useFakeTimers({ now: START + 10_000 }));
afterEach(() => vi.useRealTimers());

interface Shown {
  readonly events: string[];
  playback(): Playback;
  player: Player;
  take(topic: string, queue?: number): void;
}

/** A player of messages `[topic, seconds]`, and what it shows. */
function play(hasLive: boolean, ...messages: readonly (readonly [string, number])[]): Shown {
  const history = new History(1e6);
  for (const [topic, seconds] of messages) {
    const time = START + 1000 * seconds;
    const read = () => ({ seconds });
    history.add({ topic, type: "t/T", time, size: 10, node: "/n", read });
  }
  const events: string[] = [];
  const takers: Taker[] = [];
  let playback: Playback | undefined;
  const player = new Player(
    history,
    hasLive,
    () => takers,
    (report) => {
      if (report.kind === "jump") events.push("jump");
      else playback = report.playback;
    },
  );
  return {
    events,
    player,
    playback: () => playback as Playback,
    take(topic, queue = 1) {
      const receive = ({ message }: Delivery) =>
        void events.push(`${topic} ${String(message.seconds)}`);
      const subscriber = { topic, throttle: 0, queue, receive, fail: (why: string) => void why };
      const taker = { subscriber, inbox: new Inbox(queue, 0, receive, subscriber.fail) };
      takers.push(taker);
      player.add(taker);
    },
  };
}

it("a pause keeps what is shown, and a moment has each topic's newest message", async () => {
  const { player, events, take, playback } = play(true, ["/a", 1], ["/b", 2], ["/a", 3], ["/a", 4]);
  take("/a");
  take("/b");
  await player.control({ kind: "pause" });
  expect(events).toEqual([]);
  expect(playback()).toMatchObject({ isLive: false, speed: 0, time: START + 10_000 });
  await player.control({ kind: "seek", time: START + 3500 });
  expect(events).toEqual(["jump", "/b 2", "/a 3"]);
  expect(playback().time).toBe(START + 3500);
  await player.control({ kind: "seek", time: START + 500 });
  expect(playback().time).toBe(START + 1000);
});

it("those who want each message get those before, too", async () => {
  const { player, events, take } = play(true, ["/a", 1], ["/a", 2], ["/a", 3]);
  take("/a", 100);
  await player.control({ kind: "seek", time: START + 2000 });
  expect(events).toEqual(["jump", "/a 1", "/a 2"]);
});

it("live returns, with what has come meanwhile", async () => {
  const { player, events, take, playback } = play(true, ["/a", 1], ["/a", 2]);
  take("/a");
  await player.control({ kind: "seek", time: START + 1000 });
  await player.control({ kind: "live" });
  expect(events).toEqual(["jump", "/a 1", "jump", "/a 2"]);
  expect(player.isLive).toBe(true);
  expect(playback().isLive).toBe(true);
});

it("a panel that is opened while paused shows the same moment", async () => {
  const { player, events, take } = play(true, ["/a", 1], ["/a", 2]);
  await player.control({ kind: "seek", time: START + 1500 });
  take("/a");
  await vi.waitFor(() => expect(events).toEqual(["jump", "/a 1"]));
});

it("messages are played in their time, and at the end it pauses", async () => {
  const { player, events, take, playback } = play(false, ["/a", 1], ["/a", 2], ["/a", 4]);
  take("/a");
  await vi.advanceTimersByTimeAsync(0);
  expect(events).toEqual(["/a 1"]);
  void player.control({ kind: "play", speed: 2, loop: false });
  await vi.advanceTimersByTimeAsync(499);
  expect(events).toEqual(["/a 1"]);
  await vi.advanceTimersByTimeAsync(2);
  expect(events).toEqual(["/a 1", "/a 2"]);
  await vi.advanceTimersByTimeAsync(1100);
  expect(events).toEqual(["/a 1", "/a 2", "/a 4"]);
  expect(playback()).toMatchObject({ speed: 0, time: START + 4000 });
});

it("a pause ends playing, and it goes on from there", async () => {
  const { player, events, take, playback } = play(false, ["/a", 1], ["/a", 2], ["/a", 3]);
  take("/a");
  void player.control({ kind: "play", speed: 1, loop: false });
  await vi.advanceTimersByTimeAsync(1500);
  await player.control({ kind: "pause" });
  await vi.advanceTimersByTimeAsync(5000);
  expect(events).toEqual(["/a 1", "/a 2"]);
  expect(playback().time).toBeCloseTo(START + 2500, -1);
  void player.control({ kind: "play", speed: 1, loop: false });
  await vi.advanceTimersByTimeAsync(600);
  expect(events).toEqual(["/a 1", "/a 2", "/a 3"]);
});

it("a loop begins again, with a jump", async () => {
  const { player, events, take } = play(false, ["/a", 1], ["/a", 2]);
  take("/a");
  void player.control({ kind: "play", speed: 1, loop: true });
  await vi.advanceTimersByTimeAsync(2500);
  await player.control({ kind: "pause" });
  expect(events.slice(0, 6)).toEqual(["/a 1", "/a 2", "jump", "/a 1", "/a 2", "jump"]);
});

it("finds the next message that has a text or a number, and says if there is none", async () => {
  const messages = [1, 2, 12, 20].map((seconds) => ["/a", seconds] as const);
  const { player, events, take, playback } = play(false, ...messages);
  take("/a");
  await player.control({ kind: "find", topic: "", text: "12" });
  expect(events.slice(-2)).toEqual(["jump", "/a 12"]);
  expect(playback()).toMatchObject({ time: START + 12_000, search: "" });
  await player.control({ kind: "find", topic: "/a", text: "1" });
  expect(playback()).toMatchObject({ time: START + 12_000, search: "not found" });
  await player.control({ kind: "seek", time: START + 1000 });
  expect(playback().search).toBe("");
});

it("steps go to the next and to the previous message of a topic", async () => {
  const { player, events, take, playback } = play(
    false,
    ["/a", 1],
    ["/b", 2],
    ["/a", 3],
    ["/b", 4],
  );
  take("/a");
  take("/b");
  await vi.advanceTimersByTimeAsync(0);
  await player.control({ kind: "step", topic: "", by: 1 });
  expect(playback().time).toBe(START + 2000);
  await player.control({ kind: "step", topic: "/b", by: 1 });
  expect(playback().time).toBe(START + 4000);
  expect(events).toEqual(["/a 1", "/b 2", "/a 3", "/b 4"]);
  await player.control({ kind: "step", topic: "/b", by: -1 });
  expect(playback().time).toBe(START + 2000);
  expect(events.slice(4)).toEqual(["jump", "/a 1", "/b 2"]);
});

it("of many moments that are asked for at once, the last one is shown", async () => {
  const { player, events, take, playback } = play(true, ["/a", 1], ["/a", 2], ["/a", 3]);
  take("/a");
  await Promise.all(
    [1, 2, 3].map((seconds) => player.control({ kind: "seek", time: START + 1000 * seconds })),
  );
  expect(events.at(-1)).toBe("/a 3");
  expect(playback().time).toBe(START + 3000);
});
