"""Robot models: joints by hand, and documents that are invalid."""

from __future__ import annotations

from math import inf, pi

import pytest

from fibws.ros1.errors import UrdfError
from fibws.ros1.urdf import read_urdf
from fibws.tf.transform import roll_pitch_yaw

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <material name="blue"/>
  <link name="base"/><link name="upper"/><link name="lower"/><link name="finger"/>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/>
    <axis xyz="0 0 2"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/><limit effort="1" velocity="1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="lower"/><child link="finger"/><axis xyz="0 1 0"/>
    <limit lower="0.1" upper="0.5" effort="1" velocity="1"/>
    <mimic joint="shoulder" multiplier="2" offset="0.5"/>
  </joint>
  <joint name="mount" type="fixed">
    <parent link="finger"/><child link="tool"/><origin rpy="0.1 0.2 0.3"/>
  </joint>
</robot>"""


def test_joints_are_read_with_their_defaults() -> None:
    model = read_urdf(ARM)
    assert (model.name, model.root) == ("arm", "base")
    assert model.links == ("base", "upper", "lower", "finger", "tool")
    shoulder, elbow = model.joints["shoulder"], model.joints["elbow"]
    slide, mount = model.joints["slide"], model.joints["mount"]
    assert (shoulder.lower, shoulder.upper) == (-1, 1)
    assert shoulder.axis == pytest.approx((0, 0, 1))
    assert (elbow.lower, elbow.upper) == (-inf, inf)
    assert elbow.axis == pytest.approx((1, 0, 0))
    assert [each.moves for each in (shoulder, slide, mount)] == [True, True, False]
    assert roll_pitch_yaw(mount.origin.rotation) == pytest.approx((0.1, 0.2, 0.3))


def test_joints_move_their_links() -> None:
    model = read_urdf(ARM)
    turned = model.joints["shoulder"].at(0.5)
    assert turned.translation == pytest.approx((0, 0, 1))
    assert roll_pitch_yaw(turned.rotation)[2] == pytest.approx(pi / 2 + 0.5)
    assert model.joints["slide"].at(0.3).translation == pytest.approx((0, 0.3, 0))
    assert model.joints["mount"].at(9) == model.joints["mount"].origin


def test_joints_follow_others() -> None:
    model = read_urdf(ARM)
    known = {"shoulder": 0.25, "mount": 1.0, "unknown": 1.0}
    assert model.positions(known) == {"shoulder": 0.25, "slide": 1.0}
    assert model.positions({"slide": 0.2, "shoulder": 1.0}) == {"slide": 0.2, "shoulder": 1.0}


def robot(*parts: str) -> str:
    return f"<robot>{''.join(parts)}</robot>"


A, B, C = (f'<link name="{name}"/>' for name in "abc")


def joint(parent: str, child: str, inside: str = "", **attributes: str) -> str:
    given = {"name": f"{parent}{child}", "type": "fixed", **attributes}
    text = " ".join(f'{key}="{value}"' for key, value in given.items())
    return f'<joint {text}><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("<robot", "robot_description:1"),
        ("<launch/>", "expected <robot>"),
        (robot(), "no <link>"),
        (robot("<link/>"), "requires attribute name"),
        (robot(A, A), "duplicate link a"),
        (robot(A, B), "one link without a parent, got a, b"),
        (robot(A, B, joint("a", "b"), joint("b", "a")), "loop"),
        (robot(A, B, C, joint("b", "c"), joint("c", "b")), "loop"),
        (robot(A, B, C, joint("a", "c"), joint("b", "c")), "c has two parents, a and b"),
        (robot(A, joint("a", "x")), "unknown link x"),
        (robot(A, B, joint("a", "b"), joint("a", "b")), "duplicate joint ab"),
        (robot(A, B, joint("a", "b", type="magic")), "unknown type magic"),
        (robot(A, '<joint name="j" type="fixed"/>'), "requires one <parent>, got 0"),
        (robot(A, B, joint("a", "b", '<origin xyz="0 0"/>')), "3 finite numbers"),
        (robot(A, B, joint("a", "b", '<origin rpy="0 0 nan"/>')), "3 finite numbers"),
        (robot(A, B, joint("a", "b", '<axis xyz="0 0 0"/>', type="revolute")), "must not be 0 0 0"),
        (robot(A, B, joint("a", "b", '<mimic joint="x"/>')), "mimics the unknown joint x"),
        ('<!DOCTYPE x [<!ENTITY a "b">]><robot/>', "DOCTYPE"),
        ("<robot>" + "<a>" * 5000, "nested"),
    ],
)
def test_invalid_model_is_an_error_that_says_where(text: str, fault: str) -> None:
    with pytest.raises(UrdfError, match=r"robot_description:\d+") as caught:
        read_urdf(text)
    assert fault in str(caught.value)


def test_long_chain_is_read_at_once() -> None:
    count = 9000
    links = "".join(f'<link name="l{i}"/>' for i in range(count))
    joints = "".join(joint(f"l{i}", f"l{i + 1}") for i in reversed(range(count - 1)))
    assert len(read_urdf(robot(links, joints)).joints) == count - 1
    with pytest.raises(UrdfError, match="limit 10000"):
        read_urdf(robot("".join(f'<link name="l{i}"/>' for i in range(10_001))))
