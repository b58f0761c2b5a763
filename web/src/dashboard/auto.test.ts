import { expect, test } from "vitest";

import type { Graph, TopicInfo } from "../model";
import { KINDS } from "../panels/kinds";
import { autoLayout } from "./auto";
import { type Layout, placesOf } from "./layout";

function topic(name: string, type: string, { publishers = 1, subscribers = 0 } = {}): TopicInfo {
  const node = (at: number) => ({ node: `/node_${at}` });
  return {
    name,
    type,
    checked: true,
    publishers: Array.from({ length: publishers }, (_, at) => ({ ...node(at), latch: false })),
    subscriptions: Array.from({ length: subscribers }, (_, at) => ({
      ...node(at),
      queue_length: 0,
      throttle_rate: 0,
      compression: "",
    })),
    conflicts: [],
  };
}

function auto(...topics: TopicInfo[]): string {
  const graph: Graph = { revision: 1, nodes: [], topics, services: [], actions: [] };
  return text(autoLayout(graph));
}

function text(layout: Layout | null): string {
  if (layout === null) return "nothing";
  if (!("split" in layout)) return `${layout.view} ${layout.name}`.trim();
  return `${layout.split}(${layout.items.map(text).join(", ")})`;
}

/** A scene shows maps, too. */
const hasScene = KINDS.some(({ id }) => id === "3d");
const IMAGE = topic("/camera/image", "sensor_msgs/Image");
const MAP = topic("/map", "nav_msgs/OccupancyGrid");
const CMD = topic("/cmd_vel", "geometry_msgs/Twist", { publishers: 0, subscribers: 1 });
const DIAGNOSTICS = topic("/diagnostics", "diagnostic_msgs/DiagnosticArray");

test("a robot has its camera beside the map, over the stick and the diagnostics", () => {
  const layout = autoLayout({
    revision: 1,
    nodes: [],
    topics: [DIAGNOSTICS, CMD, MAP, IMAGE],
    services: [],
    actions: [],
  });
  const found = placesOf(layout).panes.map(({ pane, x, y }) => [pane.name, x > 0.1, y > 0.1]);
  expect(found).toEqual([
    ["/camera/image", false, false],
    [hasScene ? "" : "/map", true, false],
    ["/cmd_vel", false, true],
    ["/diagnostics", true, true],
  ]);
});

test("what is missing leaves its place to the others", () => {
  expect(auto(IMAGE)).toBe("image /camera/image");
  expect(auto(IMAGE, CMD)).toBe("col(image /camera/image, teleop /cmd_vel)");
  expect(auto(CMD, DIAGNOSTICS)).toBe("row(teleop /cmd_vel, diagnostics /diagnostics)");
});

test("the smaller images, the stick that a robot listens to and the sum of diagnostics are preferred", () => {
  const compressed = topic("/camera/image/compressed", "sensor_msgs/CompressedImage");
  expect(auto(IMAGE, compressed)).toBe("image /camera/image/compressed");
  const dead = topic("/camera/image/compressed", "sensor_msgs/CompressedImage", { publishers: 0 });
  expect(auto(IMAGE, dead)).toBe("image /camera/image");
  const joystick = topic("/a/cmd_vel", "geometry_msgs/Twist");
  expect(auto(joystick, CMD)).toBe("teleop /cmd_vel");
  const sum = topic("/diagnostics_agg", "diagnostic_msgs/DiagnosticArray");
  expect(auto(DIAGNOSTICS, sum)).toBe("diagnostics /diagnostics_agg");
});

test("a graph without pictures has echoes and the console, and an empty one nothing", () => {
  const numbers = ["/d", "/c", "/b", "/a"].map((name) => topic(name, "std_msgs/Int32"));
  expect(auto(...numbers)).toBe("col(row(raw /a, raw /b, raw /c), console)");
  expect(auto()).toBe("nothing");
  expect(auto(topic("/rosout", "rosgraph_msgs/Log"))).toBe("nothing");
});
