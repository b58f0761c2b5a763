import { describe, expect, it } from "vitest";
import type { Hub, Message, SubscribeOptions } from "../hub";
import { Feed, timeOf } from "./feed";

/** A hub that remembers what was asked of it. */
class FakeHub {
  hear: (message: Message) => void = () => undefined;
  refused: (why: string) => void = () => undefined;
  readonly said: string[] = [];

  subscribe(
    topic: string,
    options: SubscribeOptions,
    hear: (message: Message) => void,
    refused: (why: string) => void,
  ): () => void {
    this.said.push(`subscribe ${topic} ${options.throttle}`);
    this.hear = hear;
    this.refused = refused;
    return () => this.said.push(`unsubscribe ${topic}`);
  }
}

function feed(): { hub: FakeHub; feed: Feed } {
  const hub = new FakeHub();
  return { hub, feed: new Feed(hub as unknown as Hub, "/n", 20, () => undefined) };
}

describe("a feed", () => {
  it("takes the numbers out of messages, and names the path that has none", () => {
    const { hub, feed: topic } = feed();
    const x = topic.add("x");
    const inner = topic.add("list[1]");
    topic.start();
    hub.hear({ x: 8, list: [1, 2] });
    expect([x.ring.newest, inner.ring.newest, topic.odd]).toEqual([8, 2, ""]);
    hub.hear({ x: 13, list: [1] });
    expect([x.ring.newest, inner.ring.newest, topic.odd]).toEqual([13, NaN, "list[1]"]);
  });

  it("gives a new curve the newest message there is", () => {
    const { hub, feed: topic } = feed();
    topic.add("x");
    topic.start();
    hub.hear({ x: 8, y: 5 });
    expect(topic.add("y").ring.newest).toBe(5);
  });

  it("is subscribed to while it is looked at, and leaves a gap", () => {
    const { hub, feed: topic } = feed();
    const x = topic.add("x");
    topic.start();
    topic.start();
    hub.hear({ x: 8 });
    topic.throttle = 50;
    topic.throttle = 50;
    expect(x.ring.newest).toBe(8);
    topic.stop();
    expect(x.ring.newest).toBeNaN();
    expect(topic.remove(x)).toBe(true);
    expect(hub.said).toEqual([
      "subscribe /n 20",
      "unsubscribe /n",
      "subscribe /n 50",
      "unsubscribe /n",
    ]);
  });

  it("tells why the hub refuses", () => {
    const { hub, feed: topic } = feed();
    topic.start();
    hub.refused("no such type");
    expect(topic.refusal).toBe("no such type");
  });
});

describe("a sample's time", () => {
  it("is the header's, if that is about now", () => {
    const at = (secs: number): number =>
      timeOf({ header: { stamp: { secs, nsecs: 500_000_000 } } }, 1000);
    expect(at(998)).toBe(998.5);
    expect(at(1)).toBe(1000);
    expect(timeOf({ data: 1 }, 1000)).toBe(1000);
  });
});
