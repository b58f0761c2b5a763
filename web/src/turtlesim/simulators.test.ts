import { expect, test } from "vitest";

import type { Graph, TopicInfo } from "../model";
import { METER, simulatorsOf, textOf, transformOf } from "./simulators";

function topic(name: string, type: string, node: string): TopicInfo {
  const publishers = [{ node, latch: false }];
  return { name, type, checked: true, publishers, subscriptions: [], conflicts: [] };
}

const POSE = "turtlesim/Pose";
const GRAPH: Graph = {
  revision: 1,
  nodes: [],
  actions: [],
  services: [
    { name: "/spawn", type: "turtlesim/Spawn", node: "/turtlesim" },
    { name: "/second/spawn", type: "turtlesim/Spawn", node: "/second/sim" },
    { name: "/reset", type: "std_srvs/Empty", node: "/turtlesim" },
  ],
  topics: [
    topic("/turtle10/pose", POSE, "/turtlesim"),
    topic("/turtle2/pose", POSE, "/turtlesim"),
    topic("/turtlesim/picture", "sensor_msgs/CompressedImage", "/turtlesim"),
    topic("/second/turtle1/pose", POSE, "/second/sim"),
    topic("/other/pose", POSE, "/robot"),
  ],
};

test("simulators have the turtles that they publish", () => {
  expect(simulatorsOf(GRAPH)).toEqual([
    {
      node: "/second/sim",
      prefix: "/second/",
      picture: "",
      turtles: [{ name: "turtle1", base: "/second/turtle1" }],
    },
    {
      node: "/turtlesim",
      prefix: "/",
      picture: "/turtlesim/picture",
      turtles: [
        { name: "turtle2", base: "/turtle2" },
        { name: "turtle10", base: "/turtle10" },
      ],
    },
  ]);
});

test("a turtle at the lower left looks up", () => {
  const pose = { x: 1, y: 0, theta: Math.PI / 2, linear_velocity: 0, angular_velocity: 0 };
  expect(transformOf(pose)).toBe(`translate(${METER}.00 499.00) rotate(-90.00)`);
  expect(textOf(pose)).toBe("x 1.00 m, y 0.00 m, 90°");
  expect(textOf({ ...pose, linear_velocity: 2 })).toContain("2.0 m/s");
});
