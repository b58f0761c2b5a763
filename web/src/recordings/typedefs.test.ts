import { expect, it } from "vitest";
import { typedefsOf } from "./typedefs";

it("definitions have their fields, constants and inner types", () => {
  const text = `# A light.
uint8 RED=1  # stop
string NAME = a # b
float32 MAX=1.5
std_msgs/Header header
uint8[<=3] colours
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
`;
  const [light, header] = typedefsOf("lights/Light", text);
  expect(light).toMatchObject({
    type: "lights/Light",
    fieldnames: ["header", "colours"],
    fieldtypes: ["std_msgs/Header", "uint8"],
    fieldarraylen: [-1, 0],
    constnames: ["RED", "NAME", "MAX"],
    constvalues: ["1", "a # b", "1.5"],
  });
  expect(header?.fieldnames).toEqual(["seq", "stamp", "frame_id"]);
});

it("a schema that is none of ROS has no fields", () => {
  expect(typedefsOf("own.Number", '{"type": "object"}')).toEqual([]);
  expect(typedefsOf("std_msgs/Empty", "")).toEqual([]);
});
