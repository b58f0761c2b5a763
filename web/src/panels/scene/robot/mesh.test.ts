import { describe, expect, it } from "vitest";
import { readDae } from "./dae";
import { COLORED, type MeshData, packed, readStl } from "./mesh";
import { materialFiles, readMtl, readObj } from "./obj";

/** The corners of triangles, each as `x y z`. */
function corners({ plain, colored }: MeshData): string[] {
  const found: string[] = [];
  for (const [numbers, step] of [
    [plain, 6],
    [colored, COLORED],
  ] as const) {
    for (let at = 0; at < numbers.length; at += step) {
      found.push([...numbers.slice(at, at + 3)].map((each) => +each.toFixed(4) + 0).join(" "));
    }
  }
  return found;
}

function normal({ plain, colored }: MeshData, corner = 0): number[] {
  const at = corner * (plain.length > 0 ? 6 : COLORED) + 3;
  const numbers = plain.length > 0 ? plain : colored;
  return [...numbers.slice(at, at + 3)].map((each) => +each.toFixed(4) + 0);
}

/** The colours of the corners that have one. */
function colors({ colored }: MeshData): number[] {
  const bytes = new Uint32Array(colored.buffer);
  return Array.from({ length: colored.length / COLORED }, (_, at) => bytes[at * COLORED + 6] ?? 0);
}

function binaryStl(triangles: number[][], count = triangles.length): Uint8Array {
  const bytes = new Uint8Array(84 + 50 * triangles.length);
  bytes.set(new TextEncoder().encode("solid or not"));
  const view = new DataView(bytes.buffer);
  view.setUint32(80, count, true);
  for (const [index, numbers] of triangles.entries()) {
    for (const [at, number] of numbers.entries()) {
      view.setFloat32(84 + 50 * index + 12 + 4 * at, number, true);
    }
  }
  return bytes;
}

const text = (lines: string): Uint8Array => new TextEncoder().encode(lines);

describe("readStl", () => {
  it("reads binary files, whatever their head begins with", () => {
    const data = readStl(binaryStl([[0, 0, 0, 1, 0, 0, 0, 2, 0]]));
    expect(corners(data)).toEqual(["0 0 0", "1 0 0", "0 2 0"]);
    expect(normal(data)).toEqual([0, 0, 1]);
  });

  it("reads bytes that are not aligned", () => {
    const whole = new Uint8Array(200);
    const file = binaryStl([[0, 0, 0, 1, 0, 0, 0, 2, 0]]);
    whole.set(file, 3);
    expect(corners(readStl(whole.subarray(3, 3 + file.length)))).toHaveLength(3);
  });

  it("leaves out triangles that are not finite", () => {
    const data = readStl(binaryStl([[Number.NaN, 0, 0, 1, 0, 0, 0, 2, 0]]));
    expect(corners(data)).toEqual([]);
  });

  it("reads text", () => {
    const data = readStl(
      text(`solid cube
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1e0 0 0
      vertex 0 2 0
    endloop
  endfacet
endsolid`),
    );
    expect(corners(data)).toEqual(["0 0 0", "1 0 0", "0 2 0"]);
  });

  it.each([
    [text(""), "0 bytes"],
    [text("hello"), "5 bytes"],
    [binaryStl([], 1000), "byte 80", "1000"],
    [text("solid a\nvertex 1 2\n"), "line 2", "1 2"],
    [text("solid a\nvertex 1 2 3\nendloop"), "line 3"],
    [text("solid a\nvertex 1 2 3\n"), "no end"],
  ])("says where %# is wrong", (data, ...facts) => {
    for (const fact of facts) expect(() => readStl(data)).toThrow(fact);
  });
});

const QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

describe("readObj", () => {
  it("cuts polygons into triangles, and counts back from the last vertex", () => {
    const four = ["0 0 0", "1 0 0", "1 1 0", "0 0 0", "1 1 0", "0 1 0"];
    expect(corners(readObj(`${QUAD}f 1 2 3 4`))).toEqual(four);
    expect(corners(readObj(`${QUAD}f -4/1/1 -3//1 -2/1 \\\n -1`))).toEqual(four);
  });

  it("takes normals where there are some", () => {
    const data = readObj(`${QUAD}vn 1 0 0\nf 1//1 2//1 3//1`);
    expect(normal(data)).toEqual([1, 0, 0]);
    expect(normal(readObj(`${QUAD}f 1 2 3`))).toEqual([0, 0, 1]);
  });

  it("gives faces the colours of their materials", () => {
    const obj = `mtllib a b.mtl\n${QUAD}f 1 2 3\nusemtl dark red\nf 1 2 3\n`;
    expect(materialFiles(obj)).toEqual(["a b.mtl"]);
    const materials = readMtl("newmtl dark red\nKd 0.5 0 0\nd 0.5\nnewmtl plain\n");
    expect(materials.get("plain")).toEqual([0.8, 0.8, 0.8, 1]);
    const data = readObj(obj, materials);
    expect(data.plain.length / 6).toBe(3);
    expect(colors(data)).toEqual([0x80000080, 0x80000080, 0x80000080]);
  });

  it.each([
    [`${QUAD}f 1 2 9`, "line 5", "9", "4"],
    [`${QUAD}f 1 2`, "line 5", "2 corners"],
    [`${QUAD}f a b c`, "line 5"],
    ["v 0 0 zero", "line 1", "zero"],
  ])("says where %# is wrong", (obj, ...facts) => {
    for (const fact of facts) expect(() => readObj(obj)).toThrow(fact);
  });
});

function collada(mesh: string, node: string, unit = ""): string {
  return `<?xml version="1.0"?>
<COLLADA><asset>${unit}<up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="fx"><profile_COMMON><technique sid="common"><phong>
<diffuse><color>1 0 0 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="mat"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="geo"><mesh>
<source id="pos"><float_array count="12">0 0 0  1 0 0  1 1 0  0 1 0</float_array>
<technique_common><accessor stride="3"/></technique_common></source>
<source id="nor"><float_array count="3">0 0 1</float_array></source>
<vertices id="vert"><input semantic="POSITION" source="#pos"/></vertices>
${mesh}</mesh></geometry></library_geometries>
<library_nodes><node id="shared"><instance_geometry url="#geo"/></node></library_nodes>
<library_visual_scenes><visual_scene id="scene">${node}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>`;
}

const TRIANGLE = `<triangles count="1" material="sym"><input semantic="VERTEX" source="#vert" offset="0"/>
<p>0 1 2</p></triangles>`;
const NODE = `<node><instance_geometry url="#geo"/></node>`;

describe("readDae", () => {
  it("reads triangles in metres, and ignores the axis that is up", () => {
    const unit = `<unit meter="0.01" name="cm"/>`;
    expect(corners(readDae(collada(TRIANGLE, NODE, unit)))).toEqual([
      "0 0 0",
      "0.01 0 0",
      "0.01 0.01 0",
    ]);
  });

  it("reads polygons of several inputs", () => {
    const inputs = `<input semantic="VERTEX" source="#vert" offset="0"/>
<input semantic="NORMAL" source="#nor" offset="1"/>`;
    const list = `<polylist count="1">${inputs}<vcount>4</vcount><p>0 0 1 0 2 0 3 0</p></polylist>`;
    const found = readDae(collada(list, NODE));
    expect(corners(found)).toHaveLength(6);
    expect(normal(found)).toEqual([0, 0, 1]);
    const polygons = `<polygons count="1">${inputs}<p>0 0 1 0 2 0 3 0</p></polygons>`;
    expect(corners(readDae(collada(polygons, NODE)))).toEqual(corners(found));
    const strip = `<tristrips><input semantic="VERTEX" source="#vert" offset="0"/><p>0 1 3 2</p></tristrips>`;
    expect(corners(readDae(collada(strip, NODE)))).toEqual([
      ...["0 0 0", "1 0 0", "0 1 0"],
      ...["0 1 0", "1 0 0", "1 1 0"],
    ]);
  });

  it("applies the transforms of nodes, the outer one last", () => {
    const node = `<node><translate>0 0 5</translate><rotate>0 0 1 90</rotate>
<node><scale>2 2 2</scale><instance_geometry url="#geo"/></node></node>`;
    expect(corners(readDae(collada(TRIANGLE, node)))).toEqual(["0 0 5", "0 2 5", "-2 2 5"]);
    const matrix = `<node><matrix>1 0 0 7 0 1 0 8 0 0 1 9 0 0 0 1</matrix>
<instance_node url="#shared"/></node>`;
    expect(corners(readDae(collada(TRIANGLE, matrix)))[0]).toBe("7 8 9");
  });

  it("keeps the front of what is mirrored in front", () => {
    const node = `<node><scale>-1 1 1</scale><instance_geometry url="#geo"/></node>`;
    expect(normal(readDae(collada(TRIANGLE, node)))).toEqual([0, 0, 1]);
  });

  it("takes the colours of materials", () => {
    const node = `<node><instance_geometry url="#geo"><bind_material><technique_common>
<instance_material symbol="sym" target="#mat"/></technique_common></bind_material></instance_geometry></node>`;
    const found = readDae(collada(TRIANGLE, node));
    expect(found.plain).toHaveLength(0);
    expect(colors(found)).toEqual([0xff0000ff, 0xff0000ff, 0xff0000ff]);
  });

  it.each([
    ["<robot/>", "<COLLADA>", "<robot>"],
    [collada(TRIANGLE, `<node><instance_geometry url="#gone"/></node>`), "#gone", "line 14"],
    [collada(TRIANGLE.replace("0 1 2", "0 1 99"), NODE), "99", "4"],
    [collada(TRIANGLE.replace("0 1 2", "0 x 2"), NODE), "number 2"],
    [collada(TRIANGLE.replace("VERTEX", "COLOR"), NODE), "VERTEX"],
    [collada(TRIANGLE, "<node><scale>1 2</scale></node>"), "<scale>", "3"],
    [collada(TRIANGLE, `<node id="n"><instance_node url="#n"/></node>`), "loop"],
  ])("says where %# is wrong", (dae, ...facts) => {
    for (const fact of facts) expect(() => readDae(dae)).toThrow(fact);
  });

  it("limits how often nodes are used again", () => {
    const level = (name: string, next: string): string =>
      `<node id="${name}">${`<instance_node url="#${next}"/>`.repeat(20)}</node>`;
    const names = ["a", "b", "c", "d", "e", "f"];
    // The last ones have no mesh: reading that as often would take longer than the limit allows for.
    const nodes = `${names.map((name, at) => level(name, names[at + 1] ?? "none")).join("")}<node id="none"/>`;
    expect(() => readDae(collada(TRIANGLE, nodes))).toThrow("too many nodes");
  });
});

it("packs colours as bytes", () => {
  expect(packed([1, 0, 0, 1])).toBe(0xff0000ff);
  expect(packed([0, 0.5, 2, -1])).toBe(0x00ff8000);
});

describe("files that end too early", () => {
  const obj = `${QUAD}vn 0 0 1\nusemtl a\nf 1//1 2//1 3//1 4//1\n`;
  const solid = "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n";
  it.each([
    ["Collada", collada(TRIANGLE, NODE), readDae],
    ["OBJ", obj, readObj],
    ["STL", solid, (part: string) => readStl(text(part))],
  ] as [string, string, (part: string) => MeshData][])(
    "are refused, or read so far: %s",
    (_, whole, read) => {
      const complete = corners(read(whole)).length;
      for (let end = 0; end < whole.length; end += 1) {
        try {
          expect(corners(read(whole.slice(0, end))).length).toBeLessThanOrEqual(complete);
        } catch (error) {
          expect((error as Error).message).toMatch(/line \d+|no end|bytes/);
        }
      }
    },
  );

  it("are refused: binary STL", () => {
    const whole = binaryStl([[0, 0, 0, 1, 0, 0, 0, 2, 0]]);
    for (let end = 0; end < whole.length; end += 1) {
      expect(() => readStl(whole.subarray(0, end))).toThrow(/bytes/);
    }
  });
});
