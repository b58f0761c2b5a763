import { describe, expect, it } from "vitest";

import { Filter } from "../filter";
import type { Graph, TopicInfo } from "../model";
import { picture } from "./picture";
import { DEFAULTS } from "./toolbar";

const node = (name: string) => ({
  name,
  address: "127.0.0.1:1",
  since: { secs: 1, nsecs: 0 },
  own: false,
  api: "",
  fault: "",
  hub: "",
});

function topic(
  name: string,
  publishers: string[],
  subscribers: string[],
  latch = false,
): TopicInfo {
  return {
    name,
    type: "std_msgs/String",
    checked: true,
    publishers: publishers.map((each) => ({ node: each, latch })),
    subscriptions: subscribers.map((each) => ({
      node: each,
      queue_length: 0,
      throttle_rate: 0,
      compression: "none",
    })),
    conflicts: [],
  };
}

function graph(nodes: string[], topics: TopicInfo[], more: Partial<Graph> = {}): Graph {
  return { revision: 1, nodes: nodes.map(node), topics, services: [], actions: [], ...more };
}

const CHATTER = graph(["/talker", "/listener"], [topic("/chatter", ["/talker"], ["/listener"])]);

const ids = (drawn: { elements: { id: string }[] }) => drawn.elements.map(({ id }) => id);
const arrows = (drawn: { edges: { from: string; to: string }[] }) =>
  drawn.edges.map(({ from, to }) => `${from} -> ${to}`);

describe("a picture", () => {
  it("has edges from the publisher to the topic and on to the subscriber", () => {
    const drawn = picture(CHATTER, DEFAULTS);
    expect(ids(drawn)).toEqual(["topic /chatter", "node /listener", "node /talker"]);
    expect(arrows(drawn)).toEqual([
      "node /talker -> topic /chatter",
      "topic /chatter -> node /listener",
    ]);
    expect(drawn.edges[0]?.publishers).toEqual(["/chatter /talker"]);
    expect(drawn.edges[1]?.subscriptions).toEqual(["/chatter /listener"]);
  });

  it("has no quiet nodes and topics if these are hidden", () => {
    const larger = graph(
      ["/talker", "/listener", "/idle"],
      [
        topic("/chatter", ["/talker"], ["/listener"]),
        topic("/silent", ["/idle", "/talker"], ["/listener"]),
      ],
      {
        services: [
          { name: "/talker/start", type: "a/B", node: "/talker" },
          { name: "/idle/start", type: "a/B", node: "/idle" },
        ],
      },
    );
    const options = { ...DEFAULTS, services: true, quiet: false };
    const busy = (flow: string): boolean => flow === "/chatter /talker";
    expect(ids(picture(larger, options, busy))).toEqual([
      "topic /chatter",
      "node /talker",
      "service /talker/start",
    ]);
    expect(ids(picture(larger, { ...options, quiet: true }, busy))).toHaveLength(7);
    expect(ids(picture(larger, options, () => false))).toEqual([]);
  });

  it("hides the services of an excluded node, as the list of services does", () => {
    const served = graph(["/talker"], [], {
      services: [{ name: "/start", type: "a/B", node: "/talker" }],
    });
    const options = { ...DEFAULTS, services: true, filter: new Filter("-/talker") };
    expect(ids(picture(served, options))).toEqual([]);
  });

  it("has topics as labels if only nodes are drawn", () => {
    const drawn = picture(CHATTER, { ...DEFAULTS, topics: false });
    expect(ids(drawn)).toEqual(["node /listener", "node /talker"]);
    expect(arrows(drawn)).toEqual(["node /talker -> node /listener"]);
    expect(drawn.edges[0]?.label).toBe("/chatter");
  });

  it("marks latched topics", () => {
    const drawn = picture(graph(["/a"], [topic("/map", ["/a"], [], true)]), DEFAULTS);
    expect(drawn.edges[0]?.latched).toBe(true);
    expect(drawn.edges[0]?.about).toBe("/a publishes /map, latched");
  });

  it("describes each element and its number of edges", () => {
    const about = picture(CHATTER, DEFAULTS).elements.map((each) => each.about);
    expect(about).toEqual([
      "topic /chatter, type std_msgs/String, publishers 1, subscribers 1",
      "node /listener, publishes 0, subscribes 1",
      "node /talker, publishes 1, subscribes 0",
    ]);
  });

  it("hides names of the hub and of tools, unless debugging", () => {
    const noisy = graph(
      ["/talker", "/page_1234", "/fibws_tool_12_34"],
      [topic("/rosout", ["/talker"], []), topic("/chatter", ["/talker"], ["/page_1234"])],
    );
    expect(ids(picture(noisy, DEFAULTS))).toEqual(["topic /chatter", "node /talker"]);
    expect(ids(picture(noisy, { ...DEFAULTS, debug: true }))).toContain("node /page_1234");
    expect(ids(picture(noisy, { ...DEFAULTS, debug: true }))).toContain("topic /rosout");
  });

  it("shows topics without publishers or subscribers, unless dead ends are off", () => {
    const dead = graph(["/a"], [topic("/out", ["/a"], []), topic("/in", [], ["/a"])]);
    expect(ids(picture(dead, DEFAULTS))).toEqual(["node /a", "topic /in", "topic /out"]);
    expect(ids(picture(dead, { ...DEFAULTS, deadEnds: false }))).toEqual(["node /a"]);
  });

  it("keeps elements that match the filter and their neighbours", () => {
    const chain = graph(
      ["/robot/a", "/b", "/c"],
      [topic("/robot/x", ["/robot/a"], ["/b"]), topic("/y", ["/b"], ["/c"])],
    );
    const drawn = picture(chain, { ...DEFAULTS, filter: new Filter("/robot"), namespaces: false });
    expect(ids(drawn)).toEqual(["node /b", "node /robot/a", "topic /robot/x"]);
    expect(arrows(drawn)).toHaveLength(2);
    expect(ids(picture(chain, { ...DEFAULTS, filter: new Filter("y") }))).toEqual([
      "node /b",
      "node /c",
      "topic /y",
    ]);
  });

  it("leaves out excluded elements, even as neighbours", () => {
    const drawn = picture(CHATTER, { ...DEFAULTS, filter: new Filter("chatter -listener") });
    expect(ids(drawn)).toEqual(["topic /chatter", "node /talker"]);
    expect(arrows(drawn)).toHaveLength(1);
  });

  it("filters by type", () => {
    const both = graph(["/a"], [topic("/x", ["/a"], []), { ...topic("/y", [], []), type: "a/B" }]);
    expect(ids(picture(both, { ...DEFAULTS, filter: new Filter("a/b") }))).toEqual(["topic /y"]);
  });

  it("filters topics that are drawn as edges", () => {
    const nodesOnly = { ...DEFAULTS, topics: false };
    const named = picture(CHATTER, { ...nodesOnly, filter: new Filter("chatter") });
    expect(ids(named)).toEqual(["node /listener", "node /talker"]);
    const excluded = picture(CHATTER, { ...nodesOnly, filter: new Filter("-chatter") });
    expect(ids(excluded)).toHaveLength(2);
    expect(arrows(excluded)).toEqual([]);
  });

  it("shows services on demand, with a dashed edge to their node", () => {
    const serving = graph(["/adder"], [], {
      services: [{ name: "/add", type: "rospy_tutorials/AddTwoInts", node: "/adder" }],
    });
    expect(ids(picture(serving, DEFAULTS))).toEqual(["node /adder"]);
    const drawn = picture(serving, { ...DEFAULTS, services: true });
    expect(arrows(drawn)).toEqual(["service /add -> node /adder"]);
    expect(drawn.edges[0]?.dashed).toBe(true);
  });

  it("labels elements without the namespace that is drawn around them", () => {
    const drawn = picture(
      graph(["/robot/a", "/robot/b", "/c"], [topic("/robot/arm/x", ["/robot/a"], ["/c"])]),
      DEFAULTS,
    );
    expect(drawn.groups).toEqual([{ name: "/robot", parent: null }]);
    const labels = drawn.elements.map(({ group, label }) => [group, label]);
    expect(labels).toEqual([
      [null, "/c"],
      ["/robot", "a"],
      ["/robot", "arm/x"],
      ["/robot", "b"],
    ]);
  });

  it("shows types in small graphs, or as chosen", () => {
    expect(picture(CHATTER, DEFAULTS).elements[0]?.second).toBe("std_msgs/String");
    expect(picture(CHATTER, { ...DEFAULTS, types: false }).elements[0]?.second).toBe("");
    const many = graph(
      ["/a"],
      [..."abcdefghi"].map((letter) => topic(`/${letter}`, ["/a"], [])),
    );
    expect(picture(many, DEFAULTS).elements.map(({ second }) => second)).not.toContain(
      "std_msgs/String",
    );
    expect(picture(many, { ...DEFAULTS, types: true }).typed).toBe(true);
  });
});

describe("ROS 1 nodes", () => {
  const ros1 = (name: string, fault = "") => ({ ...node(name), api: `http://pi:1${name}`, fault });
  const conflict = (name: string, publishes: boolean, type = "a/B") => ({
    node: name,
    type,
    publishes,
    fault: "why",
    md5sum: "",
  });

  it("say that they are unreachable, also to screen readers", () => {
    const drawn = picture({ ...CHATTER, nodes: [ros1("/talker", "Timed out")] }, DEFAULTS);
    const talker = drawn.elements.find(({ name }) => name === "/talker");
    expect(talker?.second).toBe("⚠ unreachable");
    expect(talker?.about).toBe("node /talker, publishes 1, subscribes 0, unreachable: Timed out");
  });

  it("of another type than the topic have a flagged edge", () => {
    const chatter = {
      ...topic("/chatter", ["/talker"], ["/listener"]),
      conflicts: [conflict("/camera", true), conflict("/old", false, "std_msgs/String")],
    };
    const nodes = [...CHATTER.nodes, ros1("/camera"), ros1("/old")];
    const drawn = picture({ ...CHATTER, nodes, topics: [chatter] }, DEFAULTS);
    expect(drawn.edges.map(({ id, conflict: flag, about }) => [id, flag, about])).toEqual([
      [
        "node /camera > topic /chatter",
        "a/B",
        "/camera, /chatter: publishes a/B, the topic is std_msgs/String",
      ],
      ["node /talker > topic /chatter", "", "/talker publishes /chatter"],
      ["topic /chatter > node /listener", "", "/listener subscribes to /chatter"],
      [
        "topic /chatter > node /old",
        "no messages",
        "/old, /chatter: subscribes to std_msgs/String: why",
      ],
    ]);
    expect(drawn.edges[0]?.publishers).toEqual([]);
    const box = drawn.elements.find(({ kind }) => kind === "topic");
    expect(box?.second).toBe("⚠ 2 types");
    expect(box?.about).toContain("type std_msgs/String and a/B");
  });

  it("of the same other type exchange messages with each other", () => {
    const chatter = {
      ...topic("/chatter", ["/talker"], ["/listener"]),
      conflicts: [conflict("/camera", true), conflict("/viewer", false)],
    };
    const nodes = [...CHATTER.nodes, node("/camera"), ros1("/viewer")];
    const drawn = picture({ ...CHATTER, nodes, topics: [chatter] }, { ...DEFAULTS, topics: false });
    const flags = drawn.edges.map(({ from, to, conflict: flag }) => `${from} > ${to}: ${flag}`);
    expect(flags).toEqual([
      "node /camera > node /listener: a/B",
      "node /camera > node /viewer: ",
      "node /talker > node /listener: ",
      "node /talker > node /viewer: a/B",
    ]);
  });

  it("of two definitions of one type exchange messages with those of their own", () => {
    const other = (name: string, publishes: boolean, md5sum: string) => ({
      ...conflict(name, publishes, "std_msgs/String"),
      md5sum,
    });
    const chatter = {
      ...topic("/chatter", ["/talker"], ["/listener"]),
      conflicts: [
        other("/camera", true, "1"),
        other("/viewer", false, "1"),
        other("/b", false, "2"),
      ],
    };
    const nodes = [...CHATTER.nodes, node("/camera"), node("/viewer"), node("/b")];
    const drawn = picture({ ...CHATTER, nodes, topics: [chatter] }, { ...DEFAULTS, topics: false });
    const flags = drawn.edges.map(({ from, to, conflict: flag }) => `${from} > ${to}: ${flag}`);
    expect(flags).toEqual([
      "node /camera > node /b: no messages",
      "node /camera > node /listener: no messages",
      "node /camera > node /viewer: ",
      "node /talker > node /b: no messages",
      "node /talker > node /listener: ",
      "node /talker > node /viewer: no messages",
    ]);
  });

  it("exchange messages that the hub does not count", () => {
    const nodes = [ros1("/talker"), ros1("/listener"), node("/web")];
    const topics = [topic("/chatter", ["/talker"], ["/listener", "/web"])];
    const drawn = picture({ ...CHATTER, nodes, topics }, DEFAULTS);
    expect(drawn.edges.map(({ to, direct }) => [to, direct])).toEqual([
      ["topic /chatter", true],
      ["node /listener", true],
      ["node /web", false],
    ]);
  });
});

describe("an action over topics", () => {
  const server = ["status", "feedback", "result"].map((part) =>
    topic(`/fly/${part}`, ["/server"], part === "status" ? ["/client", "/viewer"] : ["/client"]),
  );
  const client = ["goal", "cancel"].map((part) => topic(`/fly/${part}`, ["/client"], ["/server"]));
  const flying = graph(["/client", "/server", "/viewer"], [...client, ...server], {
    actions: [{ name: "/fly", type: "demo/Fly", node: "/server", over_topics: true }],
  });

  it("is one element between its client and its server", () => {
    const drawn = picture(flying, DEFAULTS);
    expect(ids(drawn)).toEqual(["node /client", "action /fly", "node /server", "node /viewer"]);
    expect(arrows(drawn)).toEqual([
      "action /fly -> node /server",
      "action /fly -> node /viewer",
      "node /client -> action /fly",
    ]);
    const [serves, follows, asks] = drawn.edges;
    expect([serves?.bothWays, follows?.bothWays, asks?.bothWays]).toEqual([true, false, true]);
    expect(asks?.publishers).toEqual(["/fly/goal /client", "/fly/cancel /client"]);
    expect(asks?.subscriptions).toHaveLength(3);
  });

  it("is hidden with its topics if actions are off", () => {
    const drawn = picture(flying, { ...DEFAULTS, actions: false });
    expect(ids(drawn)).toEqual(["node /client", "node /server", "node /viewer"]);
  });

  it("is shown as five topics for debugging", () => {
    const drawn = picture(flying, { ...DEFAULTS, debug: true });
    expect(ids(drawn)).not.toContain("action /fly");
    expect(ids(drawn).filter((id) => id.startsWith("topic /fly/"))).toHaveLength(5);
  });
});

it("an action over operations has a dashed edge to its server", () => {
  const drawn = picture(
    graph(["/server"], [], {
      actions: [{ name: "/fly", type: "demo/Fly", node: "/server", over_topics: false }],
    }),
    DEFAULTS,
  );
  expect(arrows(drawn)).toEqual(["action /fly -> node /server"]);
  expect(drawn.edges[0]?.dashed).toBe(true);
});
