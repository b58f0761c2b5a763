import { beforeEach, describe, expect, it } from "vitest";
import { IDENTITY, type Transform, type TransformStamped, turned } from "../../transforms";
import { MAX_FRAMES, nearest, TransformBuffer } from "./tf_buffer";

function stamped(
  parent: string,
  child: string,
  secs: number,
  x: number,
  rotation = IDENTITY.rotation,
): TransformStamped {
  const stamp = { secs: Math.floor(secs), nsecs: Math.round((secs % 1) * 1e9) };
  const transform = { translation: { x, y: 0, z: 0 }, rotation };
  return { header: { stamp, frame_id: parent }, child_frame_id: child, transform };
}

let buffer: TransformBuffer;

beforeEach(() => {
  buffer = new TransformBuffer();
});

describe("TransformBuffer", () => {
  it("looks up a frame over static and moving ones, interpolated", () => {
    buffer.insert([stamped("base", "lidar", 0, 0.5)], true);
    buffer.insert([stamped("map", "base", 100, 0)], false);
    buffer.insert([stamped("map", "base", 101, 2, turned(Math.PI / 2))], false);
    const { transform, apart } = buffer.lookup("map", "lidar", 100_500);
    const half = Math.SQRT1_2 / 2;
    expect(transform.translation.x).toBeCloseTo(1 + half);
    expect(transform.translation.y).toBeCloseTo(half);
    expect(apart).toBe(0);
    expect(buffer.lookup("lidar", "lidar").transform).toEqual(IDENTITY);
    const back = buffer.lookup("lidar", "map", 100_000).transform;
    expect(back.translation.x).toBeCloseTo(-0.5);
  });

  it("takes the nearest time that it has, and says how far that is", () => {
    buffer.insert([stamped("/map", "/base", 100, 1)], false);
    buffer.insert([stamped("map", "base", 101, 2)], false);
    expect(buffer.lookup("map", "base", 103_000).apart).toBe(2000);
    expect(buffer.lookup("map", "base", 99_000).transform.translation.x).toBe(1);
    expect(buffer.lookup("map", "base").apart).toBe(0);
  });

  it("keeps ten seconds, and forgets all when time begins again", () => {
    for (let secs = 0; secs <= 40; secs += 1)
      buffer.insert([stamped("map", "a", secs, secs)], false);
    expect(buffer.lookup("map", "a", 31_000).apart).toBe(0);
    expect(buffer.lookup("map", "a", 20_000).apart).toBeGreaterThan(4000);
    buffer.insert([stamped("map", "a", 39.5, -1)], false);
    expect(buffer.lookup("map", "a").transform.translation.x).toBe(40);
    buffer.insert([stamped("map", "a", 1, 7)], false);
    expect(buffer.lookup("map", "a").transform.translation.x).toBe(7);
    buffer.insert([stamped("a", "mount", 0, 1)], true);
    buffer.clear();
    expect(buffer.names).toEqual(["a", "mount"]);
  });

  it("interpolates between some of many transforms", () => {
    for (let at = 0; at <= 1000; at += 1) {
      buffer.insert([stamped("map", "a", 100 + at / 1000, at)], false);
    }
    for (const at of [0, 333, 999, 1000]) {
      expect(buffer.lookup("map", "a", 100_000 + at).transform.translation.x).toBeCloseTo(at);
    }
  });

  it("says which frame is missing, and which one may be meant", () => {
    expect(() => buffer.lookup("map", "lidar")).toThrow("frame lidar is unknown: there is no tf");
    buffer.insert([stamped("map", "base_link", 1, 0), stamped("base_link", "lidar", 1, 0)], true);
    expect(() => buffer.lookup("map", "lidar_1")).toThrow(
      "frame lidar_1 is not in the tree: did you mean lidar?",
    );
    expect(() => buffer.lookup("map", "camera")).toThrow("known are base_link, lidar, map");
    buffer.insert([stamped("world", "other", 1, 0)], true);
    expect(() => buffer.lookup("map", "other")).toThrow(
      "frame other is not connected to map: their roots are world and map",
    );
  });

  it("ends in loops, and has a limit of frames", () => {
    buffer.insert([stamped("a", "b", 1, 0), stamped("b", "a", 1, 0)], false);
    expect(buffer.lookup("a", "b").apart).toBe(0);
    expect(() => buffer.lookup("c", "b")).toThrow("c is not in the tree");
    const many = Array.from({ length: MAX_FRAMES + 5 }, (_, at) => stamped("r", `f${at}`, 1, 0));
    buffer.insert(many, true);
    expect(buffer.names.length).toBeLessThanOrEqual(MAX_FRAMES + 2);
  });

  it("finds names that are like another one", () => {
    const names = ["base_link", "front_laser_link", "odom"];
    expect(nearest("base_Link", names)).toBe("base_link");
    expect(nearest("laser_link", names)).toBe("front_laser_link");
    expect(nearest("camera_optical", names)).toBeUndefined();
  });
});

/** Transforms and what `fibws.tf` answers to lookups: tests/web/test_scene.py makes them. */
interface Case {
  readonly transforms: { readonly message: TransformStamped; readonly isStatic: boolean }[];
  readonly lookups: {
    readonly target: string;
    readonly source: string;
    readonly stamp: number;
    readonly transform: Transform;
  }[];
}

/** The module with the cases; none but in that test. */
const file = import.meta.env.VITE_TF_CASES as string | undefined;
const { cases } = file ? ((await import(file)) as { cases: Case[] }) : { cases: [] };

describe.runIf(file)("TransformBuffer beside fibws.tf", () => {
  it.each(cases)("answers as it does %#", ({ transforms, lookups }) => {
    for (const { message, isStatic } of transforms) buffer.insert([message], isStatic);
    for (const { target, source, stamp, transform } of lookups) {
      const found = buffer.lookup(target, source, stamp).transform;
      const { rotation: q } = transform;
      const { rotation: p } = found;
      // A quaternion and its opposite are the same rotation.
      const cosine = p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w;
      expect(Math.abs(cosine)).toBeCloseTo(1, 6);
      for (const axis of ["x", "y", "z"] as const) {
        expect(found.translation[axis]).toBeCloseTo(transform.translation[axis], 6);
      }
    }
  });
});
