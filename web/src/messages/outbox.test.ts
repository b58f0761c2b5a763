import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Delivery } from "./feed";
import { Outbox, PICTURE } from "./outbox";
import type { Batch } from "./worker_messages";

let posted: (Batch | { kind: string })[];
let transferred: Transferable[];
let outbox: Outbox;

type Sent = ReturnType<typeof report>;

function report(message: Record<string, unknown>) {
  const delivery: Delivery = { message, size: 1, time: 0, node: "" };
  return { kind: "message", id: 1, delivery };
}

/** The numbers in the batches so far, and the kinds of what else was sent. */
function sent(): unknown[] {
  return posted.map((each) =>
    "reports" in each
      ? each.reports.map((report) => (report as Sent).delivery.message.data)
      : each.kind,
  );
}

beforeEach(() => {
  vi.useFakeTimers();
  posted = [];
  transferred = [];
  outbox = new Outbox((report, transfer) => {
    posted.push(report as Batch);
    transferred = transferred.concat(transfer);
  });
});

afterEach(() => {
  vi.useRealTimers();
});

describe("an outbox", () => {
  const put = (data: number, pause?: number): Promise<void> =>
    outbox.put(() => report({ data }), pause);

  it("sends a first message at once, and those that follow together", async () => {
    void put(1);
    expect(sent()).toEqual([[1]]);
    outbox.taken();
    void put(2);
    void put(3);
    expect(sent()).toEqual([[1]]);
    await vi.advanceTimersByTimeAsync(PICTURE);
    expect(sent()).toEqual([[1], [2, 3]]);
  });

  it("sends nothing before the page has taken the last batch", async () => {
    let isTaken = false;
    void put(1).then(() => {
      isTaken = true;
    });
    void put(2);
    await vi.advanceTimersByTimeAsync(10 * PICTURE);
    void put(3);
    expect(sent()).toEqual([[1]]);
    expect(isTaken).toBe(false);
    outbox.taken();
    expect(sent()).toEqual([[1], [2, 3]]);
    await vi.advanceTimersByTimeAsync(0);
    expect(isTaken).toBe(true);
  });

  it("waits as long as all of its messages may", async () => {
    void put(0);
    outbox.taken();
    void put(1, 50);
    await vi.advanceTimersByTimeAsync(PICTURE + 1);
    expect(sent()).toEqual([[0]]);
    void put(2);
    expect(sent()).toEqual([[0], [1, 2]]);
  });

  it("does not let many wait", () => {
    void put(0);
    outbox.taken();
    for (let n = 1; n <= 300; n += 1) void put(n, 50);
    expect(posted.length).toBe(2);
  });

  it("makes a report when it is sent, which may be about many messages", () => {
    void put(0);
    outbox.taken();
    const data: number[] = [];
    void outbox.put(() => report({ data: data.length }), 50);
    for (let n = 1; n <= 250; n += 1) {
      data.push(n);
      outbox.grow();
    }
    expect(sent()).toEqual([[0], [249]]);
  });

  it("keeps the order of messages and what else is sent", () => {
    void put(0);
    void put(1);
    outbox.post({ kind: "jump" });
    void put(2);
    outbox.taken();
    outbox.taken();
    outbox.post({ kind: "clock" });
    expect(sent()).toEqual([[0], [1], "jump", [2], "clock"]);
  });

  it("gives the memory of arrays away once", () => {
    const data = new Uint8Array(8);
    void outbox.put(() => report({ data, more: data.subarray(4) }));
    expect(transferred).toEqual([data.buffer]);
  });
});
