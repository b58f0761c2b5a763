"""The body of the simulated robot: its description in URDF, and where its sensors are."""

from __future__ import annotations

from fibws.programs.demo_robot.world import RADIUS, TRACK, WHEEL

LASER = (0.0, 0.2)
CAMERA = (0.15, 0.3)
"""How far in front of the robot's middle a sensor is, and how high above the floor."""
_THICK, _HIGH = 0.04, 0.11


def _link(name: str, shape: str, color: str, at: str = "0 0 0", turned: str = "0 0 0") -> str:
    geometry = f'<origin xyz="{at}" rpy="{turned}"/><geometry>{shape}</geometry>'
    return f"""\
  <link name="{name}">
    <visual>{geometry}<material name="{color}"/></visual>
    <collision>{geometry}</collision>
  </link>
"""


def _joint(name: str, type_: str, child: str, at: tuple[float, float, float]) -> str:
    x, y, z = at
    return f"""\
  <joint name="{name}" type="{type_}">
    <parent link="base_link"/><child link="{child}"/>
    <origin xyz="{x} {y} {z}"/><axis xyz="0 1 0"/>
  </joint>
"""


def _wheel(side: str, y: float) -> str:
    name = f"{side}_wheel"
    wheel = f'<cylinder radius="{WHEEL}" length="{_THICK}"/>'
    return "".join(
        (
            _link(name, wheel, "dark", turned="1.5708 0 0"),
            # A spoke shows that the wheel turns.
            _link(f"{name}_spoke", f'<box size="{1.6 * WHEEL} {_THICK + 0.004} 0.015"/>', "orange"),
            _joint(f"{name}_joint", "continuous", name, (0.0, y, WHEEL)),
            f"""\
  <joint name="{name}_spoke_joint" type="fixed">
    <parent link="{name}"/><child link="{name}_spoke"/>
  </joint>
""",
        )
    )


WHEEL_JOINTS = ("left_wheel_joint", "right_wheel_joint")
DESCRIPTION = "".join(
    (
        """\
<?xml version="1.0"?>
<robot name="demo_robot">
  <material name="blue"><color rgba="0.23 0.45 0.85 1"/></material>
  <material name="dark"><color rgba="0.16 0.17 0.2 1"/></material>
  <material name="orange"><color rgba="0.95 0.55 0.15 1"/></material>
  <material name="light"><color rgba="0.8 0.82 0.85 1"/></material>
""",
        _link(
            "base_link",
            f'<cylinder radius="{RADIUS - _THICK}" length="{_HIGH}"/>',
            "blue",
            at=f"0 0 {0.05 + _HIGH / 2}",
        ),
        _wheel("left", TRACK / 2),
        _wheel("right", -TRACK / 2),
        _link("caster", '<sphere radius="0.03"/>', "light"),
        _joint("caster_joint", "fixed", "caster", (-0.11, 0.0, 0.03)),
        _link("laser", '<cylinder radius="0.05" length="0.06"/>', "dark"),
        _joint("laser_joint", "fixed", "laser", (LASER[0], 0.0, LASER[1])),
        _link("camera", '<box size="0.04 0.1 0.05"/>', "orange"),
        _joint("camera_joint", "fixed", "camera", (CAMERA[0], 0.0, CAMERA[1])),
        _link("mast", f'<box size="0.02 0.02 {CAMERA[1] - 0.1}"/>', "light"),
        _joint("mast_joint", "fixed", "mast", (CAMERA[0] - 0.02, 0.0, CAMERA[1] / 2 + 0.05)),
        "</robot>\n",
    )
)
"""The robot in URDF; its frames laser and camera are those of tf."""
