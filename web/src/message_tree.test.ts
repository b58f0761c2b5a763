import { describe, expect, it } from "vitest";
import { leafText } from "./message_tree";

function field(type: string, array = -1): { name: string; type: string; array: number } {
  return { name: "x", type, array };
}

describe("the text of a value", () => {
  it("is exact or marked as rounded", () => {
    expect(leafText(0.1, field("float64"))).toEqual(["0.1", "number", ""]);
    expect(leafText(2n ** 53n + 1n, field("int64"))[0]).toBe("9007199254740993");
    expect(leafText(2 ** 53, field("int64"))[0]).toBe("≈ 9007199254740992");
    expect(leafText(2 ** 53, field("float64"))[0]).toBe("9007199254740992");
    expect(leafText(-Infinity, field("float32"))[0]).toBe("-inf");
    expect(leafText(-0, field("float32"))[0]).toBe("-0");
    expect(leafText(1e300, field("float64"))[0]).toBe("1e+300");
    expect(leafText(null, field("float32"))[0]).toBe("nan");
    expect(leafText(true, field("bool"))[0]).toBe("true");
  });

  it("has the length and the first bytes of a byte string", () => {
    expect(leafText(btoa("\x01\xff"), field("uint8", 0))[0]).toBe("2 bytes: 01 ff");
    expect(leafText(btoa("a".repeat(17)), field("char", 17))[0]).toBe(
      `17 bytes: ${"61 ".repeat(16)}…`,
    );
    expect(leafText("", field("uint8", 0))[0]).toBe("0 bytes");
    expect(leafText("AQID", field("string"))[0]).toBe('"AQID"');
  });

  it("has readable times", () => {
    expect(leafText({ secs: 1, nsecs: 500_000_000 }, field("duration"))[0]).toBe("1.5 s");
    expect(leafText({ secs: 1_700_000_000, nsecs: 1 }, field("time"))[0]).toMatch(
      /^2023-11-1\d \d\d:\d\d:20\.000000$/,
    );
    expect(leafText({ secs: 0, nsecs: 0 }, field("time"))[0]).toBe("0");
  });

  it("has the beginning of a long string", () => {
    expect(leafText("a".repeat(2500), field("string"))[0]).toMatch(/" … 500 more characters$/);
  });
});
