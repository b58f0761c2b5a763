import { describe, expect, it } from "vitest";
import { ago, bandwidth, bytes, dateTime, duration, figure, hertz, plural, whole } from "./format";

describe("format", () => {
  it("formats rates in few digits", () => {
    const rates: [number, string][] = [
      [0, "0 Hz"],
      [NaN, "0 Hz"],
      [-1, "0 Hz"],
      [0.001, "< 0.01 Hz"],
      [0.5, "0.50 Hz"],
      [0.999, "1.0 Hz"],
      [1, "1.0 Hz"],
      [99.9, "99.9 Hz"],
      [99.97, "100 Hz"],
      [999.4, "999 Hz"],
      [1000, "1.0 kHz"],
      [12_345, "12 kHz"],
    ];
    for (const [rate, text] of rates) expect(hertz(rate)).toBe(text);
  });

  it("formats sizes in powers of 1024", () => {
    const counts: [number, string][] = [
      [0, "0 B"],
      [-3, "0 B"],
      [999, "999 B"],
      [1000, "1.0 KiB"],
      [1536, "1.5 KiB"],
      [20 * 2 ** 20, "20 MiB"],
      [2 ** 60, "1048576 TiB"],
    ];
    for (const [count, text] of counts) expect(bytes(count)).toBe(text);
    expect(bandwidth(1536)).toBe("1.5 KiB/s");
  });

  it("formats times in the past", () => {
    const spans: [number, string][] = [
      [-1, "now"],
      [0.9, "now"],
      [1.9, "1 s ago"],
      [61, "1 min ago"],
      [7200, "2 h ago"],
      [200_000, "2 d ago"],
    ];
    for (const [secs, text] of spans) expect(ago(secs)).toBe(text);
  });

  it("formats counts and values", () => {
    expect(whole(1_234_567)).toBe("1\u202f234\u202f567");
    expect(plural(1, "topic")).toBe("1 topic");
    expect(plural(0, "topic")).toBe("0 topics");
    expect(figure(1836311903)).toBe("1836311903");
    expect(figure(0.1 + 0.2)).toBe("0.3");
    expect(figure(1.5e-7)).toBe("1.5e-7");
  });

  it("formats dates and durations", () => {
    const secs = new Date(2026, 10, 21, 20, 35, 5).getTime() / 1000;
    expect(dateTime(secs, 123_456_789)).toBe("2026-11-21 20:35:05.123456");
    expect(dateTime(0, 0)).toBe("0");
    expect(dateTime(1e300, 0)).toBe("1e+300 s");
    expect(duration(1, 500_000_000)).toBe("1.5 s");
    expect(duration(-2, 500_000_000)).toBe("-1.5 s");
    expect(duration(0, 0)).toBe("0 s");
  });
});
