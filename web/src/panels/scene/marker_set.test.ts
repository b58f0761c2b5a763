import { describe, expect, it } from "vitest";
import {
  type InteractiveMarker,
  InteractiveMarkers,
  invisible,
  type Marker,
  MarkerSet,
} from "./marker_set";

function marker(fields: Partial<Marker> = {}): Marker {
  return {
    header: { stamp: { secs: 0, nsecs: 0 }, frame_id: "map" },
    ns: "a",
    id: 1,
    type: 1,
    action: 0,
    pose: { position: { x: 0, y: 0, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
    scale: { x: 1, y: 1, z: 1 },
    color: { r: 1, g: 0, b: 0, a: 1 },
    lifetime: { secs: 0, nsecs: 0 },
    frame_locked: false,
    points: [],
    colors: [],
    text: "",
    mesh_resource: "",
    mesh_use_embedded_materials: false,
    ...fields,
  };
}

/** A set that draws a marker as its text, and the texts that were closed. */
function emptySet(): { set: MarkerSet<string>; closed: string[]; texts: () => string[] } {
  const closed: string[] = [];
  const set = new MarkerSet<string>(
    ({ text }) => text,
    (text) => closed.push(text),
  );
  return { set, closed, texts: () => [...set].map(({ drawn }) => drawn) };
}

describe("MarkerSet", () => {
  it("adds markers, and replaces those of the same namespace and id", () => {
    const { set, closed, texts } = emptySet();
    set.apply(marker({ text: "1" }), 0);
    set.apply(marker({ text: "2", id: 2 }), 0);
    set.apply(marker({ text: "3", ns: "b" }), 0);
    set.apply(marker({ text: "4" }), 0);
    expect(texts()).toEqual(["2", "3", "4"]);
    expect(closed).toEqual(["1"]);
    expect(set.namespaces).toEqual(["a", "b"]);
  });

  it("tells numbers in namespaces from ids", () => {
    const { set } = emptySet();
    set.apply(marker({ ns: "1 2", id: 3 }), 0);
    set.apply(marker({ ns: "2", id: 31 }), 0);
    set.apply(marker({ ns: "", id: 31 }), 0);
    expect(set.size).toBe(3);
  });

  it("deletes one, or all of the topic", () => {
    const { set, closed, texts } = emptySet();
    for (const id of [1, 2, 3]) set.apply(marker({ id, text: `${id}` }), 0);
    set.apply(marker({ action: 2, id: 2 }), 0);
    set.apply(marker({ action: 2, id: 99 }), 0);
    expect(texts()).toEqual(["1", "3"]);
    set.apply(marker({ ns: "other", action: 3 }), 0);
    expect(set.size).toBe(0);
    expect(closed).toEqual(["2", "1", "3"]);
  });

  it("ends lifetimes, which begin anew with each message", () => {
    const { set, texts } = emptySet();
    const lifetime = { secs: 1, nsecs: 500_000_000 };
    set.apply(marker({ text: "short", lifetime }), 1000);
    set.apply(marker({ text: "other", id: 2, lifetime }), 2000);
    set.apply(marker({ text: "ever", id: 3 }), 1000);
    expect(set.expire(2499)).toBe(2500);
    expect(set.expire(2500)).toBe(3500);
    expect(texts()).toEqual(["other", "ever"]);
    set.apply(marker({ text: "again", id: 2, lifetime }), 3000);
    expect(set.expire(4000)).toBe(4500);
    expect(set.expire(4500)).toBe(Infinity);
    expect(texts()).toEqual(["ever"]);
  });

  it("says which marker is wrong, and keeps the others", () => {
    const { set } = emptySet();
    set.apply(marker(), 0);
    expect(() => set.apply(marker({ type: 99 }), 0)).toThrow("a/1: unknown type 99");
    expect(() => set.apply(marker({ action: 7 }), 0)).toThrow("unknown action 7");
    expect(set.size).toBe(1);
  });

  it("has a limit", () => {
    const { set } = emptySet();
    const add = (): void => {
      for (let id = 0; id < 30_000; id += 1) set.apply(marker({ id }), 0);
    };
    expect(add).toThrow("limit 20000");
    set.apply(marker({ id: 7, text: "replaced" }), 0);
    expect(set.size).toBe(20_000);
  });
});

describe("invisible", () => {
  it.each([
    [{}, ""],
    [{ scale: { x: 1, y: 0, z: 1 } }, "scale"],
    [{ color: { r: 1, g: 1, b: 1, a: 0 } }, "alpha"],
    [{ type: 4, scale: { x: 0.1, y: 0, z: 0 } }, ""],
    [{ type: 4, scale: { x: 0, y: 1, z: 1 } }, "scale"],
    [{ type: 9, text: "hello", scale: { x: 0, y: 0, z: 0.2 } }, ""],
    [{ type: 9 }, "text"],
    [{ type: 0, points: [1, 2].map((x) => ({ x, y: 0, z: 0 })), scale: { x: 1, y: 2, z: 0 } }, ""],
    [{ type: 10, color: { r: 0, g: 0, b: 0, a: 0 }, mesh_use_embedded_materials: true }, ""],
    [{ type: 6, color: { r: 0, g: 0, b: 0, a: 0 }, colors: [{ r: 1, g: 0, b: 0, a: 1 }] }, ""],
  ] as [Partial<Marker>, string][])("says why %j is not seen", (fields, why) => {
    if (why === "") expect(invisible(marker(fields))).toBe("");
    else expect(invisible(marker(fields))).toContain(why);
  });
});

describe("InteractiveMarkers", () => {
  const { header, pose } = marker();
  const named = (name: string, description = ""): InteractiveMarker => {
    return { header, pose, name, description, scale: 1, controls: [] };
  };

  it("keeps the markers of each server, with their newest poses", () => {
    const all = new InteractiveMarkers();
    all.init("/a", [named("x"), named("y")]);
    all.init("/b", [named("x")]);
    const moved = { position: { x: 5, y: 0, z: 0 }, orientation: pose.orientation };
    expect(all.update("/a", [named("z")], [{ header, name: "x", pose: moved }], ["y"])).toBe(true);
    expect(all.all.map(({ name, pose: at }) => [name, at.position.x])).toEqual([
      ["x", 5],
      ["z", 0],
      ["x", 0],
    ]);
    expect(all.update("/a", [], [], [])).toBe(false);
    all.init("/a", []);
    expect(all.all).toHaveLength(1);
  });
});
