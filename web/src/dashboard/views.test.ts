/** The names that saved layouts have: they stay, whatever the page calls things. */
import { expect, it, vi } from "vitest";
import { LAYER_KINDS } from "../panels/scene/kinds";
import { LAYER_TYPES } from "../panels/scene/types";
import { VIEWS } from "./views";

vi.mock("../script_urls", () => ({ dataWorker: "" }));
vi.mock("../panels/scene/renderer", () => ({}));

it("views have the ids of layouts that are saved somewhere", () => {
  expect(VIEWS.map(({ name }) => name)).toEqual([
    ...["picture", "map", "diagnostics", "frames", "playback", "drive", "joints", "attitude"],
    ...["battery", "position", "scene", "plot", "transitions", "echo", "action", "service"],
    "console",
  ]);
});

it("each kind of layers has an id of its own", () => {
  expect(LAYER_KINDS.map(({ id }) => id).sort()).toEqual(Object.keys(LAYER_TYPES).sort());
});
