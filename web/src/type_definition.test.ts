import { expect, it } from "vitest";

import { definition } from "./type_definition";
import { typedef } from "./typedef.fixture";

it("is written as in a .msg file", () => {
  const def = typedef(
    "a/Status",
    [
      ["status", "uint8"],
      ["data", "int8", 0],
      ["c", "float64", 36],
    ],
    [
      ["LIST", "a b"],
      ["ACTIVE", "1"],
      ["PI", "3.14"],
      ["OFF", "False"],
      ["FAR", "-70000"],
    ],
  );
  expect(definition(def)).toBe(
    "string LIST=a b\nuint8 ACTIVE=1\nfloat64 PI=3.14\nbool OFF=False\nint32 FAR=-70000\n" +
      "uint8 status\nint8[] data\nfloat64[36] c",
  );
});
