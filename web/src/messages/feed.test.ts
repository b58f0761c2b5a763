import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { type Delivery, Feed, HEAD, PROTOCOL, type Subscriber } from "./feed";
import type { Fields } from "./reader";

/** A socket without a network, and the newest one. */
class FakeSocket {
  static readonly OPEN = 1;
  static newest: FakeSocket;
  readonly sent: Record<string, unknown>[] = [];
  readonly url: string;
  readyState = 0;
  protocol = "";
  binaryType = "";
  onopen = (): void => undefined;
  onmessage = (_event: { data: unknown }): void => undefined;
  onclose = (_event: { code: number; reason: string }): void => undefined;

  constructor(url: string) {
    this.url = url;
    FakeSocket.newest = this;
  }

  send(text: string): void {
    this.sent.push(JSON.parse(text) as Record<string, unknown>);
  }

  close(): void {
    this.lose(1000);
  }

  open(protocol = PROTOCOL): void {
    this.readyState = FakeSocket.OPEN;
    this.protocol = protocol;
    this.onopen();
  }

  lose(code = 1006, reason = ""): void {
    this.readyState = 3;
    this.onclose({ code, reason });
  }

  receive(operation: Record<string, unknown>): void {
    this.onmessage({ data: JSON.stringify(operation) });
  }

  receiveNumber(topicId: number, ...bytes: number[]): void {
    this.receiveAt(topicId, 0, ...bytes);
  }

  /** Receive a message that the hub had at a time in ms since 1970. */
  receiveAt(topicId: number, time: number, ...bytes: number[]): void {
    const frame = new Uint8Array(HEAD + bytes.length);
    frame[0] = 1;
    frame[1] = topicId;
    new DataView(frame.buffer).setBigUint64(5, BigInt(time) * 1_000_000n, true);
    frame.set(bytes, HEAD);
    this.onmessage({ data: frame.buffer });
  }
}

/** What the hub says of a type of one number. */
const INT8 = { type: "std_msgs/Int8", definition: "int8 data" };

class Receiver implements Subscriber {
  readonly topic = "/a";
  readonly type: string | undefined = "std_msgs/Int8";
  throttle = 50;
  queue = 1;
  readonly deliveries: Delivery[] = [];
  readonly faults: string[] = [];

  receive(delivery: Delivery): void | Promise<void> {
    this.deliveries.push(delivery);
  }

  get messages(): Fields[] {
    return this.deliveries.map(({ message }) => message);
  }

  fail(why: string): void {
    this.faults.push(why);
  }
}

let receiver: Receiver;

/** Wait until promises that are resolved have been awaited. */
async function settled(): Promise<void> {
  for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
}

function connected(token = ""): Feed {
  const feed = new Feed();
  feed.connect("ws://hub/?node=/x", token);
  return feed;
}

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("WebSocket", FakeSocket);
  receiver = new Receiver();
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe("Feed", () => {
  it("reads frames of the topics that it has subscribed to", () => {
    const feed = connected();
    const stop = feed.subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const [subscribe] = socket.sent;
    expect(subscribe).toMatchObject({ op: "subscribe", topic: "/a", compression: "ros1" });
    expect(subscribe).toMatchObject({ throttle_rate: 50, queue_length: 1 });
    socket.receive({ op: "subscribed", id: subscribe?.id, topic_id: 7, ...INT8 });
    socket.receiveNumber(7, 255);
    socket.receiveNumber(8, 5);
    expect(receiver.messages).toEqual([{ data: -1 }]);
    stop();
    expect(socket.sent.at(-1)).toMatchObject({ op: "unsubscribe", id: subscribe?.id });
    socket.receiveNumber(7, 3);
    expect(receiver.messages.length).toBe(1);
  });

  it("gives each subscriber of a topic bytes of its own", () => {
    const feed = connected();
    const bytes = { type: "x/Bytes", definition: "uint8[] data" };
    const taken: Uint8Array[] = [];
    const receive = ({ message }: Delivery): void => {
      const bytes = message.data as Uint8Array;
      taken.push(structuredClone(bytes, { transfer: [bytes.buffer as ArrayBuffer] }));
    };
    const options = { topic: "/a", throttle: 0, fail: receiver.fail.bind(receiver), receive };
    feed.subscribe({ ...options, queue: 1 });
    feed.subscribe({ ...options, queue: 1000 });
    const socket = FakeSocket.newest;
    socket.open();
    expect(socket.sent.map(({ queue_length }) => queue_length)).toEqual([1, 1000]);
    expect(socket.sent.map(({ credit }) => credit)).toEqual([2, 500]);
    for (const { id } of socket.sent) {
      socket.receive({ op: "subscribed", id, topic_id: 7, ...bytes });
    }
    socket.receiveNumber(7, 2, 0, 0, 0, 5, 6);
    expect(taken.map((bytes) => [...bytes])).toEqual([
      [5, 6],
      [5, 6],
    ]);
    expect(receiver.faults).toEqual([]);
  });

  it("has all messages of a queue, in order, however slowly they are processed", async () => {
    receiver.queue = 1000;
    receiver.throttle = 0;
    const receive = receiver.receive.bind(receiver);
    const done: (() => void)[] = [];
    receiver.receive = (delivery) => {
      void receive(delivery);
      return new Promise((resolve) => done.push(resolve));
    };
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const id = socket.sent[0]?.id;
    socket.receive({ op: "subscribed", id, topic: "/a", topic_id: 7, ...INT8, credit: 500 });
    for (let at = 0; at < 120; at += 1) socket.receiveNumber(7, at);
    await settled();
    expect(receiver.messages.map(({ data }) => data)).toEqual([...Array(120).keys()]);
    const counts = () =>
      socket.sent.filter(({ op }) => op === "acknowledge").map(({ count }) => count);
    expect(counts()).toEqual([]);
    for (const each of done) each();
    await settled();
    expect(counts()).toEqual([120]);
  });

  it("gives the newest message to those who want no queue, beside one who wants all", async () => {
    const feed = connected();
    const all = new Receiver();
    all.queue = 1000;
    all.throttle = 0;
    feed.subscribe(receiver);
    feed.subscribe(all);
    const socket = FakeSocket.newest;
    socket.open();
    for (const { id } of socket.sent)
      socket.receive({ op: "subscribed", id, topic_id: 7, ...INT8 });
    for (let at = 0; at < 100; at += 1) {
      socket.receiveNumber(7, at);
      await settled();
    }
    expect(all.messages.length).toBe(100);
    expect(receiver.messages).toEqual([{ data: 0 }]);
    await vi.advanceTimersByTimeAsync(receiver.throttle);
    expect(receiver.messages).toEqual([{ data: 0 }, { data: 99 }]);
  });

  it("gives a latched message that comes again to the new subscriber alone", async () => {
    const feed = connected();
    const other = new Receiver();
    feed.subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const subscribed = (): void => {
      const id = socket.sent.filter(({ op }) => op === "subscribe").at(-1)?.id;
      socket.receive({ op: "subscribed", id, topic_id: 7, ...INT8 });
    };
    subscribed();
    socket.receiveAt(7, 5000, 8);
    feed.subscribe(other);
    subscribed();
    socket.receiveAt(7, 5000, 8);
    await settled();
    expect([receiver.messages.length, other.messages.length]).toEqual([1, 1]);
    socket.receiveAt(7, 6000, 8);
    await vi.advanceTimersByTimeAsync(1000);
    expect([receiver.messages.length, other.messages.length]).toEqual([2, 2]);
  });

  it("takes messages to have come as the hub received them, by this computer's clock", async () => {
    vi.setSystemTime(1_000_000);
    receiver.queue = 100;
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const id = socket.sent[0]?.id;
    socket.receive({ op: "subscribed", id, topic_id: 7, ...INT8 });
    // The hub's clock is 300 s behind; the later ones wait on the way, and come together.
    socket.receiveAt(7, 700_000, 1);
    vi.setSystemTime(1_000_050);
    socket.receiveAt(7, 700_010, 2);
    socket.receiveAt(7, 700_020, 3);
    // A latched one is from long ago.
    socket.receiveAt(7, 600_000, 4);
    await vi.advanceTimersByTimeAsync(100);
    const times = receiver.deliveries.map(({ time }) => time);
    expect(times).toEqual([1_000_000, 1_000_010, 1_000_020, 1_000_050]);
  });

  it("asks for JSON if the hub does not know a type", async () => {
    receiver.throttle = 0;
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const id = socket.sent[0]?.id;
    socket.receive({ op: "status", id, level: "error", code: "unknown_definition", msg: "x" });
    expect(socket.sent.at(-1)).toMatchObject({ op: "subscribe", id });
    expect(socket.sent.at(-1)).not.toHaveProperty("compression");
    socket.receive({ op: "publish", topic: "/a", msg: { data: 3 } });
    await settled();
    expect([receiver.messages, receiver.faults]).toEqual([[{ data: 3 }], []]);
  });

  it("has the name of the node that publishes", () => {
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const id = socket.sent[0]?.id;
    socket.receive({ op: "subscribed", id, topic_id: 7, ...INT8 });
    const header = new TextEncoder().encode('{"callerid":"/robot"}');
    const frame = new Uint8Array([
      2,
      7,
      0,
      0,
      0,
      ...Array(8).fill(0),
      header.length,
      0,
      ...header,
      5,
    ]);
    socket.onmessage({ data: frame.buffer });
    expect(receiver.deliveries).toMatchObject([{ node: "/robot", message: { data: 5 } }]);
  });

  it("reports messages that it cannot read, and goes on", async () => {
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const id = socket.sent[0]?.id;
    socket.receive({ op: "subscribed", id, topic_id: 7, ...INT8 });
    socket.receiveNumber(7);
    expect(receiver.faults[0]).toContain("ends early");
    socket.receiveNumber(7, 1);
    expect(receiver.messages).toEqual([{ data: 1 }]);
    socket.receive({
      op: "subscribed",
      id,
      topic_id: 9,
      type: "std_msgs/String",
      definition: "string data",
    });
    expect(receiver.faults[1]).toBe("the topic has the type std_msgs/String now");
    socket.receiveNumber(9, 1, 0, 0, 0, 65);
    socket.receiveNumber(7, 2);
    await settled();
    expect(receiver.messages).toEqual([{ data: 1 }, { data: 2 }]);
    socket.receive({ op: "status", id, level: "error", msg: "not allowed" });
    expect(receiver.faults[2]).toBe("not allowed");
  });

  it("acknowledges messages once all their subscribers have processed them", async () => {
    const feed = connected();
    const decoded: (() => void)[] = [];
    const slow = new Receiver();
    slow.receive = () => new Promise((done) => decoded.push(() => done(undefined)));
    feed.subscribe(receiver);
    const stop = feed.subscribe(slow);
    const socket = FakeSocket.newest;
    socket.open();
    for (const { id, topic, credit } of socket.sent) {
      expect(credit).toBe(2);
      socket.receive({ op: "subscribed", id, topic, topic_id: 7, ...INT8, credit });
    }
    const acknowledgements = () => socket.sent.filter(({ op }) => op === "acknowledge");
    socket.receiveNumber(7, 1);
    await settled();
    expect(receiver.messages.length).toBe(1);
    expect(acknowledgements()).toEqual([]);
    decoded[0]?.();
    await settled();
    expect(acknowledgements()).toEqual([{ op: "acknowledge", topic: "/a", count: 1 }]);
    stop();
    socket.receiveNumber(7, 2);
    socket.receiveNumber(7); // It cannot be read.
    await settled();
    expect(acknowledgements().reduce((sum, { count }) => sum + Number(count), 0)).toBe(3);
  });

  it("acknowledges many messages together, and the last ones after a while", async () => {
    receiver.queue = 10_000;
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const { id, topic, credit } = socket.sent[0] as Record<string, unknown>;
    expect(credit).toBe(500);
    socket.receive({ op: "subscribed", id, topic, topic_id: 7, ...INT8, credit });
    const counts = () =>
      socket.sent.filter(({ op }) => op === "acknowledge").map(({ count }) => Number(count));
    for (let n = 0; n < 100; n += 1) {
      socket.receiveNumber(7, n);
      await settled();
    }
    expect(counts().length).toBe(1);
    await vi.advanceTimersByTimeAsync(1000);
    expect(counts().reduce((sum, count) => sum + count, 0)).toBe(100);
    expect(counts().length).toBe(2);
  });

  it("acknowledges messages that came before it had unsubscribed", async () => {
    const stop = connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    const id = socket.sent[0]?.id;
    const topic = "/a";
    socket.receive({ op: "subscribed", id, topic, topic_id: 7, ...INT8, credit: 2 });
    stop();
    socket.receiveNumber(7, 1);
    await settled();
    expect(receiver.messages).toEqual([]);
    expect(socket.sent.at(-1)).toEqual({ op: "acknowledge", topic, count: 1 });
  });

  it("acknowledges nothing on another connection, or to a hub without credit", async () => {
    connected().subscribe(receiver);
    const first = FakeSocket.newest;
    let decode = (): void => undefined;
    receiver.receive = () => new Promise((done) => (decode = () => done(undefined)));
    first.open();
    const id = first.sent[0]?.id;
    const topic = "/a";
    first.receive({ op: "subscribed", id, topic, topic_id: 7, ...INT8, credit: 2 });
    first.receiveNumber(7, 1);
    first.lose();
    vi.runOnlyPendingTimers();
    const second = FakeSocket.newest;
    second.open();
    second.receive({ op: "subscribed", id, topic, topic_id: 7, ...INT8 });
    decode();
    await settled();
    second.receiveNumber(7, 1);
    decode();
    await settled();
    for (const { sent } of [first, second])
      expect(sent.map(({ op }) => op)).not.toContain("acknowledge");
  });

  it("connects again, with its token, and subscribes again", () => {
    const feed = connected("secret");
    feed.subscribe(receiver);
    const first = FakeSocket.newest;
    first.open();
    expect(first.sent[0]).toEqual({ op: "auth", token: "secret" });
    first.lose();
    expect(receiver.faults).toEqual(["the connection was lost"]);
    vi.runOnlyPendingTimers();
    const second = FakeSocket.newest;
    expect(second).not.toBe(first);
    second.open();
    expect(second.sent.map(({ op }) => op)).toEqual(["auth", "subscribe"]);
    second.lose(4401, "token expired");
    vi.runOnlyPendingTimers();
    expect(FakeSocket.newest).toBe(second);
    expect(receiver.faults.at(-1)).toBe("token expired");
    feed.connect("ws://hub/?node=/x", "other");
    FakeSocket.newest.open();
    expect(FakeSocket.newest.sent.map(({ op }) => op)).toEqual(["auth", "subscribe"]);
    feed.connect("ws://hub/?node=/x", "other");
    expect(FakeSocket.newest.sent.length).toBe(2);
  });

  it("takes back that the connection was lost, also before there are messages", () => {
    connected().subscribe(receiver);
    FakeSocket.newest.open();
    FakeSocket.newest.lose();
    expect(receiver.faults).toEqual(["the connection was lost"]);
    vi.runOnlyPendingTimers();
    FakeSocket.newest.open();
    expect(receiver.faults).toEqual(["the connection was lost", ""]);
    const id = FakeSocket.newest.sent[0]?.id;
    FakeSocket.newest.receive({ op: "status", id, level: "error", msg: "not allowed" });
    expect(receiver.faults.at(-1)).toBe("not allowed");
  });

  it("takes JSON from servers without fibws.v1", () => {
    connected().subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open("");
    expect(socket.sent[0]).not.toHaveProperty("compression");
    socket.receive({ op: "publish", topic: "/a", msg: { data: 3 } });
    expect(receiver.messages).toEqual([{ data: 3 }]);
  });

  it("stays closed until it is connected again", () => {
    const feed = connected();
    feed.subscribe(receiver);
    const socket = FakeSocket.newest;
    socket.open();
    feed.close();
    vi.runOnlyPendingTimers();
    expect(FakeSocket.newest).toBe(socket);
    feed.connect("ws://hub/", "");
    FakeSocket.newest.open();
    expect(FakeSocket.newest.sent[0]).toMatchObject({ op: "subscribe", topic: "/a" });
  });
});
