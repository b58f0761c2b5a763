import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Clock } from "../../clock";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import { IDENTITY } from "../../transforms";
import { Camera } from "./camera";
import { pack } from "./cloud";
import { Entry } from "./entry";
import { LAYER_KINDS } from "./kinds";
import {
  type KnownPlaces,
  type Layer,
  type LayerKind,
  NO_PROBLEMS,
  Places,
  type Theme,
  View,
} from "./layer";
import { TYPES as TYPES_OF_MARKERS } from "./marker_set";
import { TransformBuffer } from "./tf_buffer";

vi.mock("../../script_urls", () => ({ meshWorker: "", dataWorker: "", layoutWorker: "" }));

let transforms: TransformBuffer;
let known: KnownPlaces;

beforeEach(() => {
  // Layers of markers make boxes for their namespaces.
  const nothing = (): void => undefined;
  const element = {
    replaceChildren: nothing,
    append: nothing,
    setAttribute: nothing,
    addEventListener: nothing,
  };
  vi.stubGlobal("document", { createElement: () => element });
  vi.stubGlobal("HTMLInputElement", class {});
  vi.stubGlobal("location", { href: "http://robot:9090/" });
  vi.stubGlobal("window", globalThis);
  vi.spyOn(console, "debug").mockReturnValue();
  transforms = new TransformBuffer();
  known = new WeakMap();
  move("base_link", 100);
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

/** Let tf say where a frame is in the map, at a time in seconds. */
function move(name: string, secs: number): void {
  const header = { stamp: { secs, nsecs: 0 }, frame_id: "map" };
  transforms.insert([{ header, child_frame_id: name, transform: IDENTITY }], false);
}

/** An entry of the scene, whose layer takes messages from the test. */
function started(kind: LayerKind, isStream = false): Promise<Entry> {
  return new Promise((made) => {
    const surroundings = {
      hub: {
        url: "ws://robot:9090/",
        second: () => ({ token: "" }),
        clock: new Clock(),
      } as DataSource,
      model: {} as Model,
      transforms,
      redraw: () => made(entry),
    };
    const own = { ...kind, isOwn: true, isStream };
    const entry = new Entry(surroundings, own, "/topic", "");
    entry.start();
  });
}

function draw(entry: Entry): void {
  const theme = {} as Theme;
  entry.draw(new View(new Camera(), "map", theme, transforms, known));
}

function state(entry: Entry): string {
  const { level, text } = entry.state(Date.now(), true, new Places("map", transforms, known));
  return `${level}: ${text}`;
}

function kindOf(type: string): LayerKind {
  return LAYER_KINDS.find(({ types }) => types.includes(type)) as LayerKind;
}

/** A message that any layer of a type can draw, in a frame and at a time in seconds. */
function message(type: string, frame_id: string, secs: number): Record<string, unknown> {
  const header = { stamp: { secs, nsecs: 0 }, frame_id };
  const zero = { x: 0, y: 0, z: 0 };
  const pose = { position: zero, orientation: { ...zero, w: 1 } };
  const fields: Record<string, Record<string, unknown>> = {
    "sensor_msgs/LaserScan": {
      angle_min: 0,
      angle_increment: 1,
      range_min: 0,
      range_max: 9,
      ranges: [1],
      intensities: [],
    },
    "sensor_msgs/PointCloud": {
      packed: pack({ points: [zero], channels: [] }, { color: "auto", field: "" }, 9),
    },
    "geometry_msgs/PoseStamped": { pose },
    "geometry_msgs/PointStamped": { point: zero },
    "geometry_msgs/TwistStamped": { twist: { linear: zero, angular: zero } },
    "sensor_msgs/Range": { range: 1, field_of_view: 1, min_range: 0, max_range: 9 },
    "sensor_msgs/CameraInfo": { width: 4, height: 3, K: [1, 0, 0, 0, 1, 0, 0, 0, 1] },
    "nav_msgs/Path": { poses: [{ pose }] },
    "nav_msgs/GridCells": { cells: [zero], cell_width: 1, cell_height: 1 },
    "nav_msgs/OccupancyGrid": {
      info: { width: 1, height: 1, resolution: 1, origin: pose },
      data: [0],
    },
    "visualization_msgs/Marker": {
      ns: "",
      id: 0,
      type: 1,
      action: 0,
      pose,
      scale: { x: 1, y: 1, z: 1 },
      color: { r: 1, g: 1, b: 1, a: 1 },
      lifetime: { secs: 0, nsecs: 0 },
      frame_locked: false,
      points: [],
      colors: [],
      text: "",
      mesh_resource: "",
      mesh_use_embedded_materials: false,
    },
  };
  return { header, ...fields[type] };
}

const TYPES = Object.entries({
  "sensor_msgs/LaserScan": "1 points",
  "sensor_msgs/PointCloud": "1 points",
  "geometry_msgs/PoseStamped": "x 0.00",
  "geometry_msgs/PointStamped": "0.00",
  "geometry_msgs/TwistStamped": "0.00",
  "sensor_msgs/Range": "1.00 m",
  "sensor_msgs/CameraInfo": "4 × 3",
  "nav_msgs/Path": "1 pose",
  "nav_msgs/GridCells": "1 cell",
  "nav_msgs/OccupancyGrid": "1 × 1 cells",
  "visualization_msgs/Marker": "1 marker",
});

describe.each(TYPES)("The state of a layer of %s", (type, facts) => {
  it.each([
    ["", 0, "warn: no frame_id: shown in map"],
    ["nowhere", 0, "bad: frame nowhere is not in the tree"],
    ["base_link", 100, `good: ${facts}`],
  ])(
    "of a message in the frame “%s” is the same however often it is drawn",
    async (frame, secs, text) => {
      const entry = await started(kindOf(type));
      entry.layer?.receive?.(message(type, frame, secs), Date.now());
      for (let picture = 0; picture < 3; picture += 1) {
        draw(entry);
        expect(state(entry)).toContain(text);
      }
    },
  );

  it("is known without a picture, and follows tf without one", async () => {
    const entry = await started(kindOf(type));
    entry.layer?.receive?.(message(type, "arm", 100), Date.now());
    expect(state(entry)).toContain("bad: frame arm is not in the tree");
    move("arm", 100);
    expect(state(entry)).toContain(`good: ${facts}`);
    entry.layer?.receive?.(message(type, "", 100), Date.now());
    expect(state(entry)).toContain("warn: no frame_id: shown in map");
  });
});

describe("The state of a layer", () => {
  it("has how far tf is from the time of a message, until tf has that time", async () => {
    const entry = await started(kindOf("sensor_msgs/LaserScan"));
    entry.layer?.receive?.(message("sensor_msgs/LaserScan", "base_link", 105), Date.now());
    for (const _ of [1, 2]) {
      draw(entry);
      expect(state(entry)).toBe("warn: tf is 5.0 s from the message's time");
    }
    move("base_link", 106);
    expect(state(entry)).toContain("good: 1 points");
  });

  it("has what came last, and for how long nothing has come since", async () => {
    const entry = await started(kindOf("sensor_msgs/LaserScan"), true);
    entry.layer?.receive?.(message("sensor_msgs/LaserScan", "base_link", 100), Date.now());
    const later = Date.now() + 64_500;
    const { level, text } = entry.state(later, true, new Places("map", transforms, known));
    expect([level, text]).toEqual([
      "warn",
      expect.stringMatching(/^1 points.*, no message for \d+ s$/),
    ]);
  });

  it("has why settings cannot be used, until they can", async () => {
    const entry = await started(kindOf("sensor_msgs/CameraInfo"));
    entry.layer?.receive?.(message("sensor_msgs/CameraInfo", "base_link", 100), Date.now());
    vi.spyOn(entry.layer as Layer, "update").mockImplementationOnce(() => {
      throw new Error("too deep");
    });
    entry.update();
    expect(state(entry)).toBe("bad: too deep");
    entry.update();
    expect(state(entry)).toContain("good: 4 × 3");
  });

  it("has why a mesh is missing while there is a marker with it", async () => {
    const type = "visualization_msgs/Marker";
    const entry = await started(kindOf(type));
    const marker = message(type, "base_link", 100);
    const mesh = {
      ...marker,
      type: TYPES_OF_MARKERS.indexOf("mesh"),
      mesh_resource: "file:///a.stl",
    };
    entry.layer?.receive?.(mesh, Date.now());
    // It is first loaded when it is drawn.
    draw(entry);
    await Promise.resolve();
    expect(state(entry)).toContain("bad: file:///a.stl: a browser cannot open this address");
    entry.layer?.receive?.({ ...mesh, action: 2 }, Date.now());
    expect(state(entry)).toBe("good: 0 markers");
  });

  it("is that of drawing if a layer cannot be drawn, until it can", async () => {
    let fault = "no memory";
    const layer: Layer = {
      draw: () => {
        if (fault !== "") throw new Error(fault);
      },
      problems: () => NO_PROBLEMS,
      facts: () => "drawn",
      close: () => undefined,
    };
    const entry = await started({ ...kindOf("nav_msgs/Path"), make: () => layer });
    for (const _ of [1, 2]) {
      draw(entry);
      expect(state(entry)).toBe("bad: no memory");
    }
    fault = "";
    draw(entry);
    expect(state(entry)).toBe("good: drawn");
  });
});
