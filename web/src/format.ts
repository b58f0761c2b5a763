/** Rates, sizes, times and numbers as text, the same in every view. */

const BINARY = ["B", "KiB", "MiB", "GiB", "TiB"];

/** Messages per second: `0 Hz`, `0.50 Hz`, `1.0 Hz`, `120 Hz`, `4.2 kHz`. */
export function hertz(rate: number): string {
  if (!(rate > 0)) return "0 Hz";
  if (rate < 0.01) return "< 0.01 Hz";
  if (rate < 0.995) return `${rate.toFixed(2)} Hz`;
  if (rate < 99.95) return `${rate.toFixed(1)} Hz`;
  if (rate < 999.5) return `${rate.toFixed(0)} Hz`;
  return `${(rate / 1000).toFixed(rate < 9950 ? 1 : 0)} kHz`;
}

/** A number of bytes: `0 B`, `999 B`, `1.5 KiB`, `20 MiB`. */
export function bytes(count: number): string {
  let rest = Math.max(0, count);
  let unit = 0;
  while (rest >= 999.5 && unit < BINARY.length - 1) {
    rest /= 1024;
    unit += 1;
  }
  return `${rest.toFixed(unit === 0 || rest >= 9.95 ? 0 : 1)} ${BINARY[unit]}`;
}

/** Bytes per second: `1.5 KiB/s`. */
export function bandwidth(rate: number): string {
  return `${bytes(rate)}/s`;
}

/** A time `secs` seconds ago: `now`, `3 s ago`, `5 min ago`, `2 h ago`. */
export function ago(secs: number): string {
  if (!(secs >= 1)) return "now";
  if (secs < 60) return `${Math.floor(secs)} s ago`;
  if (secs < 3600) return `${Math.floor(secs / 60)} min ago`;
  if (secs < 86_400) return `${Math.floor(secs / 3600)} h ago`;
  return `${Math.floor(secs / 86_400)} d ago`;
}

/** A count with its noun: `1 publisher`, `2 publishers`. */
export function plural(count: number, one: string, many = `${one}s`): string {
  return `${whole(count)} ${count === 1 ? one : many}`;
}

/** A whole number with thin spaces between thousands: `12 000`. */
export function whole(count: number): string {
  return String(Math.round(count)).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

/** A value in few digits, for legends: `0.1`, `1836311903`, `1.5e-7`. */
export function figure(value: number): string {
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return String(value);
  return String(Number(value.toPrecision(6)));
}

/** A local date and time to the microsecond: `2026-11-21 20:35:15.123456`; `0` if it is not set. */
export function dateTime(secs: number, nsecs: number): string {
  if (secs === 0 && nsecs === 0) return "0";
  const date = new Date(secs * 1000);
  if (Number.isNaN(date.getTime())) return `${secs} s`;
  const day = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
  return `${day} ${timeOfDay(secs)}.${String(Math.floor(nsecs / 1000)).padStart(6, "0")}`;
}

/** The local time of day in seconds: `20:35:15`. */
export function timeOfDay(secs: number): string {
  const date = new Date(secs * 1000);
  return [date.getHours(), date.getMinutes(), date.getSeconds()].map(two).join(":");
}

function two(part: number): string {
  return String(part).padStart(2, "0");
}

/** A duration to the nanosecond, without trailing zeros: `1.5 s`. */
export function duration(secs: number, nsecs: number): string {
  const negative = secs < 0 && nsecs > 0;
  const [whole, rest] = negative ? [-(secs + 1), 1e9 - nsecs] : [secs, nsecs];
  const fraction = String(rest).padStart(9, "0").replace(/0+$/, "");
  return `${negative ? "-" : ""}${whole}${fraction && `.${fraction}`} s`;
}
