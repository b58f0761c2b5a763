"""The md5 sums are those of the real ROS."""

from pathlib import Path

import pytest

from fibws.interfaces import Interfaces

SUMS = [
    line.split() for line in (Path(__file__).parent / "MD5SUMS").read_text("utf-8").splitlines()
]


@pytest.fixture(scope="module")
def interfaces() -> Interfaces:
    return Interfaces()


def test_every_type_has_a_known_md5() -> None:
    assert len(SUMS) == 185


def test_md5_sums_are_those_of_real_ros(interfaces: Interfaces) -> None:
    for expected, kind, name in SUMS:
        found = interfaces.md5(name) if kind == "msg" else interfaces.service_md5(name)
        assert found == expected, name


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("actionlib_tutorials/FibonacciAction", "f59df5767bf7634684781c92598b2406"),
        ("actionlib_tutorials/AveragingAction", "628678f2b4fa6a5951746a4a2d39e716"),
        ("rospy_tutorials/Floats", "420cd38b6b071cd49f2970c3e2cee511"),
        ("rospy_tutorials/HeaderString", "c99a9440709e4d4a9716d55b8270d5e7"),
        ("turtlesim/Pose", "863b248d5016ca62ea2e895ae5265cf9"),
        ("turtlesim/Color", "353891e354491c51aabe32df673fb446"),
        ("tf/tfMessage", "94810edda583a504dfda3829e70d7eec"),
        ("move_base_msgs/MoveBaseAction", "70b6aca7c7f7746d8d1609ad94c80bb8"),
        ("move_base_msgs/RecoveryStatus", "a2488e0805e1529a31044786ee1a2623"),
        ("control_msgs/FollowJointTrajectoryAction", "bc4f9b743838566551c0390c65f1a248"),
    ],
)
def test_types_of_the_tutorials_have_the_published_md5(
    interfaces: Interfaces, name: str, expected: str
) -> None:
    assert interfaces.md5(name) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("turtlesim/Kill", "c1f3d28f1b044c871e6eff2e9fc3c667"),
        ("turtlesim/SetPen", "9f452acce566bf0c0954594f69a8e41b"),
        ("turtlesim/Spawn", "0b2d2e872a8e2887d5ed626f2bf2c561"),
        ("turtlesim/TeleportAbsolute", "a130bc60ee6513855dc62ea83fcc5b20"),
        ("turtlesim/TeleportRelative", "9d5c2dcd348ac8f76ce2a4307bd63a13"),
        ("tf/FrameGraph", "c4af9ac907e58e906eb0b6e3c58478c0"),
    ],
)
def test_services_of_turtlesim_and_tf_have_the_published_md5(
    interfaces: Interfaces, name: str, expected: str
) -> None:
    assert interfaces.service_md5(name) == expected


def test_md5_ignores_comments_and_ros_2_syntax(tmp_path: Path) -> None:
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Old.msg").write_text("time t # when\nstring[] s\nstd_msgs/Int32 x")
    (folder / "New.msg").write_text(
        "builtin_interfaces/Time t\nwstring<=3[<=4] s\n\nstd_msgs/msg/Int32 x"
    )
    interfaces = Interfaces([tmp_path])
    assert interfaces.md5("my_msgs/Old") == interfaces.md5("my_msgs/New")
