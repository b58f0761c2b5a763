import { expect, test } from "vitest";

import { Filter } from "../filter";
import { stateOf, withState } from "../view";
import { DEFAULTS, optionsOf, stateOfOptions } from "./toolbar";

test("default options leave no state in the URL", () => {
  expect(withState("#/graph", stateOfOptions(DEFAULTS))).toBe("#/graph");
  expect(optionsOf(new URLSearchParams())).toEqual(DEFAULTS);
});

test("options survive a round trip through the URL", () => {
  const options = {
    topics: false,
    services: true,
    actions: false,
    deadEnds: false,
    quiet: false,
    debug: true,
    namespaces: false,
    types: true,
    filter: new Filter("/robot -/tf"),
  };
  const hash = withState("#/graph/node/%2Frobot", stateOfOptions(options));
  expect(optionsOf(stateOf(hash) as URLSearchParams)).toEqual(options);
});

test.each(["debug=yes", "debug=", "elements=3", "services=2", "unknown=1"])(
  "an invalid state is ignored: %s",
  (query) => expect(optionsOf(new URLSearchParams(query))).toEqual(DEFAULTS),
);
