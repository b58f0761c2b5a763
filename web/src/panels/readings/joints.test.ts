import { expect, test } from "vitest";

import { jointsOf } from "./joints";

test("limits of joints are read from a robot's description", () => {
  const urdf = `<?xml version="1.0"?>
    <robot name="arm">
      <!-- <joint name="old" type="revolute"><limit lower="-9" upper="9"/></joint> -->
      <link name="base"/>
      <joint name="hip" type="revolute">
        <parent link="base"/> <limit effort="30" lower="-1.5" upper='0.5' velocity="1"/>
      </joint>
      <joint type='prismatic' name='lift'><limit upper="0.4" effort="1" velocity="1"/></joint>
      <joint name="wheel" type="continuous"><limit effort="1" velocity="9"/></joint>
      <joint name="camera" type="fixed"/>
      <transmission name="t"><joint name="hip"><hardwareInterface/></joint></transmission>
    </robot>`;
  expect(Object.fromEntries(jointsOf(urdf))).toEqual({
    hip: { type: "revolute", lower: -1.5, upper: 0.5 },
    lift: { type: "prismatic", lower: 0, upper: 0.4 },
    wheel: { type: "continuous", lower: undefined, upper: undefined },
    camera: { type: "fixed", lower: undefined, upper: undefined },
  });
});

test.each(["", "<joint", '<joint name="a" type="revolute"><limit lower="x" upper="1"', "<!--"])(
  "the broken description %j does no harm",
  (urdf) => {
    for (const { lower } of jointsOf(urdf).values()) expect(lower).toBeUndefined();
  },
);
