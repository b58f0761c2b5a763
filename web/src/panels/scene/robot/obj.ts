/** Reads Wavefront OBJ, and the colours of its materials in MTL. */
import type { Color } from "../colors";
import { LineError, lines, MeshBuilder, type MeshData, type Point, pointOf } from "./mesh";

/** The files with materials that an OBJ names. */
export function materialFiles(text: string): string[] {
  return [...text.matchAll(/^mtllib[ \t]+(\S.*?)\s*$/gm)].map(([, name]) => name as string);
}

/** Read the colours of materials, by their names; throws a `LineError`. */
export function readMtl(text: string): Map<string, Color> {
  const found = new Map<string, Color>();
  let name = "";
  for (const [number, words] of lines(text)) {
    const [key = "", ...values] = words;
    const [red, green, blue, alpha] = found.get(name) ?? [0.8, 0.8, 0.8, 1];
    switch (key) {
      case "newmtl":
        name = values.join(" ");
        found.set(name, [0.8, 0.8, 0.8, 1]);
        break;
      case "Kd":
        // A spectrum or other units are rare, and no colours.
        if (!Number.isNaN(Number(values[0]))) found.set(name, [...pointOf(number, words), alpha]);
        break;
      case "d":
        if (Number(values[0]) > 0) found.set(name, [red, green, blue, Number(values[0])]);
        break;
    }
  }
  return found;
}

/** Read an OBJ; throws a `LineError`. */
export function readObj(text: string, colors: ReadonlyMap<string, Color> = new Map()): MeshData {
  const builder = new MeshBuilder();
  const places: Point[] = [];
  const normals: Point[] = [];
  let color: Color | undefined;
  const whole = text.includes("\\") ? text.replace(/\\\r?\n/g, " ") : text;
  for (const [number, words] of lines(whole)) {
    switch (words[0]) {
      case "v":
        places.push(pointOf(number, words));
        break;
      case "vn":
        normals.push(pointOf(number, words));
        break;
      case "usemtl":
        color = colors.get(words.slice(1).join(" "));
        break;
      case "f": {
        const corners = words.slice(1).map((word) => {
          const [place = "", , normal = ""] = word.split("/");
          const at = found(places, place);
          if (at === undefined) {
            throw new LineError(number, `no vertex ${place}: there are ${places.length}`);
          }
          return { place: at, normal: found(normals, normal) };
        });
        if (corners.length < 3) {
          throw new LineError(number, `a face of ${corners.length} corners`);
        }
        for (let at = 2; at < corners.length; at += 1) {
          const three = [corners[0], corners[at - 1], corners[at]] as typeof corners;
          const own = three.map(({ normal }) => normal);
          builder.add(
            ...(three.map(({ place }) => place) as [Point, Point, Point]),
            color,
            own.includes(undefined) ? undefined : (own as [Point, Point, Point]),
          );
        }
        break;
      }
    }
  }
  return builder.data;
}

/** The point of an index from 1 on, or of one that counts back from the last. */
function found(points: readonly Point[], index: string): Point | undefined {
  const number = Number.parseInt(index, 10);
  return number < 0 ? points.at(number) : points[number - 1];
}
