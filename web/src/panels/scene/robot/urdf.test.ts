import { describe, expect, it } from "vitest";
import { rollPitchYaw, type Transform } from "../../../transforms";
import { jointAt, ofRollPitchYaw, placesOf, positionsOf, readUrdf } from "./urdf";

const ARM = `<robot name="arm">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base">
    <visual>
      <origin xyz="0 0 0.1"/>
      <geometry><box size="0.2 0.3 0.4"/></geometry>
      <material name="red"/>
    </visual>
    <visual>
      <geometry><mesh filename="package://arm/base.dae" scale="1 -1 1"/></geometry>
      <material name="own"><color rgba="0 1 0 0.5"/></material>
    </visual>
    <collision><geometry><cylinder radius="0.1" length="0.5"/></geometry></collision>
  </link>
  <link name="tip"/>
  <link name="upper"/>
  <link name="finger"><visual><geometry><sphere radius="0.05"/></geometry></visual></link>
  <joint name="wrist" type="prismatic">
    <parent link="upper"/><child link="tip"/>
    <axis xyz="0 0 2"/><limit lower="0" upper="0.5" effort="1" velocity="1"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="follower" type="revolute">
    <parent link="tip"/><child link="finger"/><axis xyz="1 0 0"/>
    <mimic joint="shoulder" multiplier="-2" offset="0.5"/>
  </joint>
</robot>`;

function place(transform: Transform | undefined): number[] {
  const { x, y, z } = transform?.translation ?? { x: 9, y: 9, z: 9 };
  return [x, y, z].map((each) => Math.round(each * 1e9) / 1e9 + 0);
}

describe("readUrdf", () => {
  it("reads links with their shapes and colours", () => {
    const { name, root, links } = readUrdf(ARM);
    expect([name, root]).toEqual(["arm", "base"]);
    const base = links.get("base");
    expect(base?.visual[0]?.geometry).toEqual({ kind: "box", size: { x: 0.2, y: 0.3, z: 0.4 } });
    expect(base?.visual[0]?.color).toEqual([1, 0, 0, 1]);
    expect(place(base?.visual[0]?.origin)).toEqual([0, 0, 0.1]);
    expect(base?.visual[1]?.geometry).toEqual({
      kind: "mesh",
      uri: "package://arm/base.dae",
      scale: { x: 1, y: -1, z: 1 },
    });
    expect(base?.visual[1]?.color).toEqual([0, 1, 0, 0.5]);
    expect(base?.collision[0]?.geometry).toEqual({ kind: "cylinder", radius: 0.1, length: 0.5 });
    expect(links.get("finger")?.visual[0]?.color).toBeUndefined();
  });

  it("sorts joints from the root on, with their limits and axes", () => {
    const { joints } = readUrdf(ARM);
    expect(joints.map((each) => each.name)).toEqual(["shoulder", "wrist", "follower"]);
    const [shoulder, wrist, follower] = joints;
    expect([shoulder?.lower, shoulder?.upper]).toEqual([-1, 2]);
    expect(wrist?.axis).toEqual({ x: 0, y: 0, z: 1 });
    expect(follower?.lower).toBe(-Infinity);
    expect(follower?.mimic).toEqual({ joint: "shoulder", multiplier: -2, offset: 0.5 });
  });

  it("moves links by the positions of joints, also of those that follow others", () => {
    const model = readUrdf(ARM);
    const known = new Map([
      ["shoulder", Math.PI / 2],
      ["wrist", 0.5],
      ["unknown", 1],
    ]);
    const positions = positionsOf(model, known);
    expect([...positions.keys()]).toEqual(["shoulder", "wrist", "follower"]);
    expect(positions.get("follower")).toBeCloseTo(0.5 - Math.PI);
    const places = placesOf(model, positions);
    expect(place(places.get("upper"))).toEqual([0, 0, 1]);
    // The arm points along x of the shoulder, which is turned to y of the base.
    expect(place(places.get("tip"))).toEqual([0, 0.5, 1]);
  });

  it("takes the places of links that are known, and hangs the others on them", () => {
    const model = readUrdf(ARM);
    const at = { translation: { x: 5, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
    const places = placesOf(model, new Map([["wrist", 0.2]]), (link) =>
      link === "upper" ? at : undefined,
    );
    expect(place(places.get("base"))).toEqual([0, 0, 0]);
    expect(place(places.get("tip"))).toEqual([5, 0, 0.2]);
  });

  it.each([
    ["<robot", "line 1"],
    ["<xacro/>", "<robot>"],
    ["<robot/>", "<link>"],
    ["<robot><link name='a'/>\n<link name='a'/></robot>", "line 2", "duplicate link a"],
    ["<robot><link name='a'/><link name='b'/></robot>", "a, b"],
    [ARM.replace('type="prismatic"', 'type="slide"'), "line 18", "slide", "prismatic"],
    [ARM.replace('link="upper"/><child', 'link="upppper"/><child'), "upppper"],
    [ARM.replace('xyz="0 0 2"', 'xyz="0 0"'), "xyz", "3 finite numbers", "0 0"],
    [ARM.replace('xyz="0 0 2"', 'xyz="0 0 0"'), "wrist", "0 0 0"],
    [ARM.replace('size="0.2 0.3 0.4"', 'size="a b c"'), "line 6", "a b c"],
    [ARM.replace("<sphere radius", "<ball radius"), "<ball>", "<sphere>"],
    [ARM.replace('joint="shoulder"', 'joint="elbow"'), "elbow"],
    [ARM.replace('rgba="1 0 0 1"', 'rgba="1 0 0"'), "rgba", "4"],
    [ARM.replace('parent link="base"', 'parent link="finger"'), "loop"],
    [ARM.replace('child link="tip"', 'child link="upper"'), "two parents"],
  ])("says what is wrong %#", (text, ...facts) => {
    for (const fact of facts) expect(() => readUrdf(text)).toThrow(fact);
  });

  it("finds a loop", () => {
    const joint = (name: string, parent: string, child: string) =>
      `<joint name="${name}" type="fixed"><parent link="${parent}"/><child link="${child}"/></joint>`;
    const links = ["a", "b", "c"].map((name) => `<link name="${name}"/>`).join("");
    const loop = joint("1", "b", "c") + joint("2", "c", "b");
    expect(() => readUrdf(`<robot>${links}${loop}</robot>`)).toThrow("loop");
  });
});

describe("rotations", () => {
  it("turns about fixed axes: x first", () => {
    const [roll, pitch, yaw] = rollPitchYaw(ofRollPitchYaw(0.1, 0.2, 0.3));
    expect([roll, pitch, yaw].map((each) => each.toFixed(9))).toEqual([
      "0.100000000",
      "0.200000000",
      "0.300000000",
    ]);
  });

  it("leaves joints alone that do not move", () => {
    const [joint] = readUrdf(ARM.replace('type="revolute"', 'type="floating"')).joints;
    expect(joint && jointAt(joint, 1)).toBe(joint?.origin);
  });
});

interface Case {
  readonly urdf: string;
  readonly known: Readonly<Record<string, number>>;
  /** By links: x, y and z, and the rotation's x, y, z and w. */
  readonly places: Readonly<Record<string, readonly number[]>>;
}

/** The module with the cases of tests/web/test_urdf.py; none but in that test. */
const file = import.meta.env.VITE_URDF_CASES as string | undefined;
const { cases } = file ? ((await import(file)) as { cases: Case[] }) : { cases: [] };

describe.runIf(file)("robot_state_publisher", () => {
  it.each(cases)("has links at the same places %#", ({ urdf, known, places }) => {
    const model = readUrdf(urdf);
    const found = placesOf(model, positionsOf(model, new Map(Object.entries(known))));
    expect([...found.keys()].sort()).toEqual(Object.keys(places).sort());
    for (const [link, expected] of Object.entries(places)) {
      const { translation, rotation } = found.get(link) as Transform;
      const { x, y, z, w } = rotation;
      const turn = [x, y, z, w];
      // Two quaternions are the same rotation.
      const sign = turn.reduce((sum, each, at) => sum + each * (expected[3 + at] ?? 0), 0) < 0;
      const numbers = [
        ...[translation.x, translation.y, translation.z],
        ...turn.map((each) => (sign ? -each : each)),
      ];
      for (const [at, number] of numbers.entries()) {
        expect(number).toBeCloseTo(expected[at] ?? Number.NaN, 9);
      }
    }
  });
});
