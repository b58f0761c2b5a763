import { expect, it } from "vitest";

import { passes, recall, remember, USUAL } from "./choices";

function storage(text: string | null) {
  const kept = { text };
  return {
    kept,
    getItem: () => kept.text,
    setItem: (_key: string, value: string) => {
      kept.text = value;
    },
  };
}

it("remembers what was chosen", () => {
  const place = storage(null);
  remember({ ...USUAL, debug: true, namespaces: false, filter: "/robot" }, () => place);
  expect(recall(() => place)).toEqual({
    ...USUAL,
    debug: true,
    namespaces: false,
    filter: "/robot",
  });
});

it.each([null, "", "no JSON", "null", "3", '{"debug": "yes", "filter": 3}'])(
  "is as usual where %s was kept",
  (text) => {
    expect(recall(() => storage(text))).toEqual(USUAL);
  },
);

it("works where storage is forbidden", () => {
  const forbidden = (): never => {
    throw new Error("forbidden");
  };
  expect(recall(forbidden)).toEqual(USUAL);
  expect(() => remember(USUAL, forbidden)).not.toThrow();
});

it("filters by namespace from the beginning, and by other texts anywhere", () => {
  expect(passes("/robot/scan", "/robot")).toBe(true);
  expect(passes("/my/robot", "/robot")).toBe(false);
  expect(passes("/my/robot", " robot ")).toBe(true);
  expect(passes("/anything", "")).toBe(true);
});
