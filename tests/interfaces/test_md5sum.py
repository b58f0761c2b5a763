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
    assert len(SUMS) == 216


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


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("control_msgs/GripperCommandAction", "950b2a6ebe831f5d4f4ceaba3d8be01e"),
        ("control_msgs/JointControllerState", "987ad85e4756f3aef7f1e5e7fe0595d1"),
        ("control_msgs/JointJog", "1685da700c8c2e1254afc92a5fb89c96"),
        ("control_msgs/PidState", "b138ec00e886c10e73f27e8712252ea6"),
        ("control_msgs/PointHeadAction", "7252920f1243de1b741f14f214125371"),
        ("control_msgs/SingleJointPositionAction", "c4a786b7d53e5d0983decf967a5a779e"),
        ("gazebo_msgs/PerformanceMetrics", "884f71fd5037b886ec5e126b83c4425a"),
        ("gazebo_msgs/WorldState", "de1a9de3ab7ba97ac0e9ec01a4eb481e"),
        ("geographic_msgs/GeographicMap", "0f4ce6d2ebf9ac9c7c4f3308f6ae0731"),
        ("geographic_msgs/RouteNetwork", "fd717c0a34a7c954deed32c6847f30a8"),
        ("moveit_msgs/ExecuteTrajectoryAction", "add56f6df2e6f2ee8830e030d0953807"),
        ("moveit_msgs/MotionSequenceItem", "605a152161827d49a0abacf6c6544d1e"),
        ("moveit_msgs/MoveGroupAction", "33225407c32b189345eec6893a5a0da3"),
        ("moveit_msgs/MoveGroupSequenceAction", "0d3375f4fb59ed3ba86fa746e5d8e219"),
        ("moveit_msgs/PlaceLocation", "7b53f032c68481686026c3e9223d0713"),
        ("moveit_msgs/PlannerInterfaceDescription", "3b93afb00ba165a83730c4eb03cd1ab7"),
        ("moveit_msgs/PlanningScene", "acfc50bcfd6c7b978066bfa7c786002c"),
        ("moveit_msgs/DisplayRobotState", "61c4e677a6fbbc83f0d5d9df2be85e3c"),
        ("object_recognition_msgs/ObjectRecognitionAction", "7d8979a0cf97e5078553ee3efee047d2"),
        ("object_recognition_msgs/RecognizedObjectArray", "bad6b1546b9ebcabb49fb3b858d78964"),
        ("octomap_msgs/Octomap", "9a45536b45c5e409cd49f04bb2d9999f"),
        ("smach_msgs/SmachContainerInitialStatusCmd", "45f8cf31fc29b829db77f23001f788d6"),
        ("smach_msgs/SmachContainerStatus", "5ba2bb79ac19e3842d562a191f2a675b"),
        ("smach_msgs/SmachContainerStructure", "3d3d1e0d0f99779ee9e58101a5dcf7ea"),
        ("uuid_msgs/UniqueID", "fec2a93b6f5367ee8112c9c0b41ff310"),
    ],
)
def test_types_of_robots_have_the_published_md5(
    interfaces: Interfaces, name: str, expected: str
) -> None:
    assert interfaces.md5(name) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("gazebo_msgs/GetLightProperties", "df2cef87e13e2e6990e81e8aaa454c19"),
        ("gazebo_msgs/GetModelState", "4c515e936d3319c9610c559c60bfc3d4"),
        ("gazebo_msgs/GetPhysicsProperties", "575a5e74786981b7df2e3afc567693a6"),
        ("gazebo_msgs/SetJointTrajectory", "88f5c10979e3f9649d5ae87a3b12aa65"),
        ("gazebo_msgs/SetLightProperties", "e6f13430c57278bb364aca53a1bf5ebf"),
        ("geographic_msgs/GetGeoPath", "ee0dbd181711a70f823cc5d415fa609b"),
        ("geographic_msgs/UpdateGeographicMap", "93db3f1ec099e9f1b7e442d7d397e244"),
        ("moveit_msgs/ChangeDriftDimensions", "0d34c8d563fea2efff65829c37132a15"),
        ("moveit_msgs/GetStateValidity", "06ea62db671e4dbf878eaca241db51ad"),
        ("moveit_msgs/SetPlannerParams", "14bebee5d4d53a2df94b7f146d3eb2ff"),
    ],
)
def test_services_of_robots_have_the_published_md5(
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
