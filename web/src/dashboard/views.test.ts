/** The names that saved layouts have: they stay, whatever the page calls things. */
import { expect, it, vi } from "vitest";
import { LAYER_KINDS } from "../panels/scene/kinds";
import { LAYER_TYPES } from "../panels/scene/types";
import { fromFile } from "./layout";
import { VIEWS, viewNamed } from "./views";

vi.mock("../script_urls", () => ({ dataWorker: "" }));
vi.mock("../panels/scene/renderer", () => ({}));

it("views have the ids of layouts that are saved somewhere", () => {
  expect(VIEWS.map(({ name }) => name)).toEqual([
    ...["image", "map", "diagnostics", "transforms", "playback", "teleop", "joints", "attitude"],
    ...["battery", "position", "3d", "plot", "transitions", "raw", "publish", "action", "service"],
    ...["console", "graph", "topics", "services", "parameters", "reconfigure"],
  ]);
});

it("layouts of earlier versions have other names", () => {
  const earlier = ["picture", "frames", "drive", "scene", "echo", "plot"];
  expect(earlier.map((name) => viewNamed(name)?.name)).toEqual([
    "image",
    "transforms",
    "teleop",
    "3d",
    "raw",
    "plot",
  ]);
  const { layout } = fromFile('{"schema": 1, "layout": {"view": "picture", "name": "/camera"}}');
  expect(layout).toMatchObject({ view: "image", name: "/camera" });
});

it("each kind of layers has an id of its own", () => {
  expect(LAYER_KINDS.map(({ id }) => id).sort()).toEqual(Object.keys(LAYER_TYPES).sort());
});
