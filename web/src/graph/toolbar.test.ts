import { expect, test } from "vitest";

import { Filter } from "../filter";
import { DEFAULTS, loadOptions, saveOptions } from "./toolbar";

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

test("options are loaded as they were saved", () => {
  const place = storage(null);
  saveOptions(
    { ...DEFAULTS, debug: true, namespaces: false, filter: new Filter("/robot") },
    () => place,
  );
  expect(loadOptions(() => place)).toEqual({
    ...DEFAULTS,
    debug: true,
    namespaces: false,
    filter: new Filter("/robot"),
  });
});

test.each([null, "", "no JSON", "null", "3", '{"debug": "yes", "filter": 3}'])(
  "options have their defaults if %s was saved",
  (text) => {
    expect(loadOptions(() => storage(text))).toEqual(DEFAULTS);
  },
);

test("options have their defaults if storage is forbidden", () => {
  const forbidden = (): never => {
    throw new Error("forbidden");
  };
  expect(loadOptions(forbidden)).toEqual(DEFAULTS);
  expect(() => saveOptions(DEFAULTS, forbidden)).not.toThrow();
});
