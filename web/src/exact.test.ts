/** What the page shows is what was sent: each type of a field, in each panel that shows such. */
import { describe, expect, it, vi } from "vitest";
import { type Entry, line } from "./console/log";
import { leafText } from "./message_tree";
import { readDefinition } from "./messages/definition";
import { type Fields, makeReader } from "./messages/reader";
import { jsonText, numberAt } from "./messages/values";
import { DiagnosticsTree, type Status } from "./panels/diagnostics/tree";
import { Frames } from "./panels/frames/frames";
import { shownText } from "./text";
import { csv } from "./topics/plot_state";
import { recording } from "./topics/recording.fixture";
import { Curve } from "./topics/sampler";
import type { TransformStamped } from "./transforms";
import type { Field } from "./types";

vi.mock("./script_urls", () => ({ dataWorker: "" }));

type Write = (view: DataView) => void;

/** Bytes of a size, as a view writes them. */
function bytes(size: number, write: Write): number[] {
  const view = new DataView(new ArrayBuffer(size));
  write(view);
  return [...new Uint8Array(view.buffer)];
}

const int = (size: number, value: bigint): number[] =>
  bytes(8, (view) => view.setBigInt64(0, value, true)).slice(0, size);
const float32 = (value: number) => bytes(4, (view) => view.setFloat32(0, value, true));
const float64 = (value: number) => bytes(8, (view) => view.setFloat64(0, value, true));
const text = (...codes: number[]) => [...int(4, BigInt(codes.length)), ...codes];

/** A field's type and value as bytes; in Echo and feedback, in plots and CSV, and in copies. */
const TABLE: [type: string, sent: number[], echo: string, plot: string, copy: string][] = [
  ["bool", [1], "true", "1", "true"],
  ["bool", [0], "false", "0", "false"],
  ["int8", int(1, -128n), "-128", "-128", "-128"],
  ["byte", int(1, -1n), "-1", "-1", "-1"],
  ["uint8", int(1, 255n), "255", "255", "255"],
  ["char", int(1, 65n), "65", "65", "65"],
  ["int16", int(2, -32768n), "-32768", "-32768", "-32768"],
  ["uint16", int(2, 65535n), "65535", "65535", "65535"],
  ["int32", int(4, -(2n ** 31n)), "-2147483648", "-2147483648", "-2147483648"],
  ["uint32", int(4, 2n ** 32n - 1n), "4294967295", "4294967295", "4294967295"],
  ...[2n ** 53n + 1n, 2n ** 63n - 1n, -(2n ** 63n), 0n].map((value): (typeof TABLE)[number] => [
    "int64",
    int(8, value),
    String(value),
    String(value),
    String(value),
  ]),
  ["uint64", int(8, -1n), "18446744073709551615", "18446744073709551615", "18446744073709551615"],
  ["float32", float32(0.5), "0.5", "0.5", "0.5"],
  ["float32", float32(Infinity), "inf", "inf", "1e999"],
  ["float32", float32(-Infinity), "-inf", "-inf", "-1e999"],
  ["float32", float32(NaN), "nan", "nan", "null"],
  ["float32", float32(-0), "-0", "-0", "-0.0"],
  ["float64", float64(0.1), "0.1", "0.1", "0.1"],
  ["float64", float64(5e-324), "5e-324", "5e-324", "5e-324"],
  ["float64", float64(Number.MAX_VALUE), String(Number.MAX_VALUE), ...twice(Number.MAX_VALUE)],
  ["float64", float64(Infinity), "inf", "inf", "1e999"],
  ["float64", float64(-Infinity), "-inf", "-inf", "-1e999"],
  ["float64", float64(NaN), "nan", "nan", "null"],
  ["float64", float64(-0), "-0", "-0", "-0.0"],
  ["string", text(0xc3, 0xbc), '"ü"', "", '"ü"'],
  ["string", text(), '""', "", '""'],
  ["string", text(0x61, 0, 0x62), '"a\0b"', "", '"a\\u0000b"'],
  ["string", text(0x63, 0xe9), '"c\\xe9"', "", '"c\\udce9"'],
  ["string", text(0xef, 0xbb, 0xbf), '"\ufeff"', "", '"\ufeff"'],
  ["time", [...int(4, 0n), ...int(4, 0n)], "0", "0", '{"secs":0,"nsecs":0}'],
  [
    "duration",
    [...int(4, -2n), ...int(4, 500_000_000n)],
    "-1.5 s",
    "-1.5",
    '{"secs":-2,"nsecs":500000000}',
  ],
];

function twice(value: number): [string, string] {
  return [String(value), String(value)];
}

/** What of a message is compared: JSON without the blanks between its parts. */
function compact(json: string): string {
  return json
    .replace(/\n */g, "")
    .replace(/^\{"data": (.*)\}$/s, "$1")
    .replaceAll('": ', '":');
}

function read(type: string, sent: number[]): Fields {
  return makeReader(readDefinition("x/X", `${type} data`))(Uint8Array.from(sent));
}

describe.each(TABLE)("a field of %s", (type, sent, echo, plot, copy) => {
  const field = (array: number): Field => ({ name: "data", type, array });

  it(`is ${echo} in Echo, in feedback and in results`, () => {
    expect(shownText(leafText(read(type, sent).data, field(-1))[0])).toBe(echo);
  });

  it(`is ${plot || "nothing"} in plots, their legend and their CSV`, () => {
    const curve = new Curve("data");
    recording(curve)(read(type, sent), 1);
    const rows = csv([{ name: ["/x", "data"], samples: curve.samples.all() }]).split("\r\n");
    expect(rows[1] ?? "").toBe(plot === "" ? "" : `1.000000,${plot}`);
    expect(curve.samples.newest === undefined).toBe(plot === "");
  });

  it(`is ${copy} in copies`, () => {
    expect(compact(jsonText(read(type, sent)))).toBe(copy);
  });

  it("is the same as an element of an array", () => {
    for (const [definition, start] of [
      [`${type}[]`, int(4, 2n)],
      [`${type}[2]`, []],
    ] as const) {
      const message = read(definition, [...start, ...sent, ...sent]);
      const list = message.data as ArrayLike<unknown>;
      expect(list.length).toBe(2);
      expect(shownText(leafText(list[1], field(-1))[0])).toBe(
        type === "bool" ? echo : shownText(leafText(read(type, sent).data, field(-1))[0]),
      );
      expect(numberAt(message, ["data", 1])).toEqual(numberAt(read(type, sent), ["data"]));
    }
  });
});

it.each(["uint8", "char"])("an array of %s is shown as bytes", (type) => {
  const message = read(`${type}[]`, [...int(4, 3n), 0, 128, 255]);
  expect(leafText(message.data, { name: "data", type, array: 0 })[0]).toBe("3 bytes: 00 80 ff");
  expect(compact(jsonText(message))).toBe('"AID/"');
});

/** A text that is not UTF-8, and what is shown for it. */
const [ODD, SHOWN] = [read("string", text(0x6e, 0xff)).data as string, "n\\xff"];

describe("a text that is not UTF-8", () => {
  it("is in diagnostics as it was sent", () => {
    const tree = new DiagnosticsTree();
    const status = { level: 0, name: ODD, message: ODD, hardware_id: "", values: [] };
    tree.update([status] as Status[], 0);
    const [item] = tree.root.children.values();
    expect([item?.label, item?.status?.message].map((each) => shownText(each ?? ""))).toEqual([
      SHOWN,
      SHOWN,
    ]);
  });

  it("is in tf as it was sent", () => {
    const frames = new Frames();
    const zero = { x: 0, y: 0, z: 0 };
    const transform: TransformStamped = {
      header: { stamp: { secs: 0, nsecs: 0 }, frame_id: "map" },
      child_frame_id: ODD,
      transform: { translation: zero, rotation: { ...zero, w: 1 } },
    };
    frames.update([transform], { node: "", isStatic: true }, 0);
    expect(frames.names.map(shownText)).toEqual(["map", SHOWN]);
    // Two that differ in such a byte are two frames.
    const other = { ...transform, child_frame_id: read("string", text(0x6e, 0xfe)).data as string };
    frames.update([other], { node: "", isStatic: true }, 0);
    expect(frames.names.length).toBe(3);
  });

  it("is in the log as it was sent", () => {
    const times = { number: 1, secs: 0, nsecs: 0 };
    const entry: Entry = { ...times, level: 2, node: "/a", text: ODD, where: "" };
    expect(shownText(line(entry))).toBe(`[INFO] [0.000000] [/a]: ${SHOWN}`);
  });
});
