"""``fibws msg``; most of it is the same in ``fibws srv``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest
from click.testing import CliRunner, Result
from hub_in_thread import Run

from fibws.cli.commands import command
from fibws.client.hub_client import HubClient

Alone: TypeAlias = Callable[..., Result]

POINT = ["geometry_msgs/Point position", "  float64 x", "  float64 y", "  float64 z"]


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> Alone:
    """Run ``fibws`` without a hub."""
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    monkeypatch.delenv("FIBWS_INTERFACES", raising=False)

    def run(*words: str, input: str | None = None) -> Result:
        return CliRunner().invoke(command, words, input=input, prog_name="fibws")

    return run


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of definitions."""
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Thing.msg").write_text(
        "# A thing.\nuint8 RED=1  # the default\nuint8 colour\nfloat32[<=3] where\n"
    )
    return tmp_path


# show


def test_show_prints_as_rosmsg(alone: Alone) -> None:
    result = alone("msg", "show", "shape_msgs/Plane")
    assert (result.exit_code, result.output) == (0, "float64[4] coef\n\n")
    lines = alone("msg", "show", "geometry_msgs/PoseWithCovarianceStamped").output.splitlines()
    assert lines == [
        "std_msgs/Header header",
        "  uint32 seq",
        "  time stamp",
        "  string frame_id",
        "geometry_msgs/PoseWithCovariance pose",
        "  geometry_msgs/Pose pose",
        *(f"    {line}" for line in POINT),
        "    geometry_msgs/Quaternion orientation",
        *(f"      float64 {axis}" for axis in "xyzw"),
        "  float64[36] covariance",
        "",
    ]


def test_constants_come_first(alone: Alone) -> None:
    lines = alone("msg", "show", "diagnostic_msgs/DiagnosticStatus").output.splitlines()
    assert lines[:5] == ["byte OK=0", "byte WARN=1", "byte ERROR=2", "byte STALE=3", "byte level"]
    assert lines[-4:] == [
        "diagnostic_msgs/KeyValue[] values",
        "  string key",
        "  string value",
        "",
    ]


def test_info_is_an_alias_of_show(alone: Alone) -> None:
    shown = alone("msg", "show", "std_msgs/Int32").output
    assert alone("msg", "info", "std_msgs/msg/Int32").output == shown == "int32 data\n\n"


def test_type_without_a_package_is_found_in_all_packages(alone: Alone, folder: Path) -> None:
    assert alone("msg", "show", "Int32").output == "[std_msgs/Int32]:\nint32 data\n\n"
    assert alone("msg", "show", "Int32.msg").output == "[std_msgs/Int32]:\nint32 data\n\n"
    (folder / "my_msgs" / "msg" / "Int32.msg").write_text("int32 mine\n")
    assert alone("msg", "show", "--interfaces", str(folder), "Int32").output == (
        "[my_msgs/Int32]:\nint32 mine\n\n[std_msgs/Int32]:\nint32 data\n\n"
    )


def test_messages_of_actions_are_shown(alone: Alone) -> None:
    output = alone("msg", "show", "actionlib_tutorials/FibonacciActionGoal").output
    assert output.splitlines()[-3:] == [
        "actionlib_tutorials/FibonacciGoal goal",
        "  int32 order",
        "",
    ]


def test_type_may_be_read_from_standard_input(alone: Alone) -> None:
    assert alone("msg", "show", input="\nstd_msgs/Int32\n").output == "int32 data\n\n"
    assert alone("msg", "show", input="").exit_code == 2


def test_raw_prints_the_file(alone: Alone, folder: Path) -> None:
    words = ("msg", "show", "-r", "--interfaces", str(folder), "my_msgs/Thing")
    lines = alone(*words).output.splitlines()
    assert lines[:2] == ["# A thing.", "uint8 RED=1  # the default"]


def test_definitions_are_found_in_folders(
    alone: Alone, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = ["uint8 RED=1", "uint8 colour", "float32[<=3] where", ""]
    named = alone("msg", "show", "--interfaces", str(folder), "my_msgs/Thing")
    assert named.output.splitlines() == lines
    monkeypatch.setenv("FIBWS_INTERFACES", str(folder))
    assert alone("msg", "show", "my_msgs/Thing").output.splitlines() == lines
    result = alone("msg", "show", "--interfaces", str(folder / "no"), "my_msgs/Thing")
    assert (result.exit_code, result.stdout) == (1, "")
    assert str(folder / "no") in result.stderr


def test_invalid_definition_is_reported(alone: Alone, folder: Path) -> None:
    (folder / "my_msgs" / "msg" / "Bad.msg").write_text("int32 x\nwhatever\n")
    result = alone("msg", "show", "--interfaces", str(folder), "my_msgs/Bad")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "Bad.msg, line 2:" in result.stderr


def test_unknown_types_are_requested_from_the_hub(run: Run, client: HubClient) -> None:
    client.send(
        {
            "op": "advertise",
            "topic": "/things",
            "type": "hub_msgs/Thing",
            "definition": "uint8 RED=1\nduration took\ngeometry_msgs/Point[2] ends\n",
        }
    )
    client.call("/rosapi/get_time")
    assert run("msg", "show", "hub_msgs/Thing").output.splitlines() == [
        "RED=1",
        "duration took",
        "geometry_msgs/Point[2] ends",
        "  float64 x",
        "  float64 y",
        "  float64 z",
        "",
    ]
    result = run("msg", "show", "-r", "hub_msgs/Thing")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "hub_msgs/Thing" in result.stderr


def test_unknown_type_is_an_error(run: Run) -> None:
    result = run("msg", "show", "std_msgs/Int31")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "std_msgs/Int31" in result.stderr
    assert "hub ws://127.0.0.1:" in result.stderr
    assert result.stderr.endswith("; did you mean std_msgs/Int32?\n")


def test_unknown_type_without_a_hub_is_an_error(alone: Alone) -> None:
    result = alone("msg", "show", "no_msgs/Qqqqqq")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "no_msgs/Qqqqqq" in result.stderr and "ws://127.0.0.1:1 " in result.stderr


@pytest.mark.parametrize(("type_", "nearest"), [("Int31", "std_msgs/Int32"), ("Qqqqqq", None)])
def test_unknown_name_is_an_error(alone: Alone, type_: str, nearest: str | None) -> None:
    for verb in ("show", "md5"):
        result = alone("msg", verb, type_)
        assert (result.exit_code, result.stdout) == (1, "")
        hint = f"; did you mean {nearest}?" if nearest else ""
        assert f"'{type_}'{hint}\n" in result.stderr


@pytest.mark.parametrize("type_", ["std_msgs/a/Int32", "/std_msgs/Int32", "std-msgs/Int32"])
def test_invalid_type_is_wrong_usage(alone: Alone, type_: str) -> None:
    result = alone("msg", "show", type_)
    assert result.exit_code == 2
    assert repr(type_) in result.stderr


# list, package, packages, md5


def test_list_prints_all_types(alone: Alone, folder: Path) -> None:
    found = alone("msg", "list", "--interfaces", str(folder)).output.splitlines()
    assert {"std_msgs/Int32", "my_msgs/Thing", "actionlib_tutorials/FibonacciGoal"} <= set(found)
    as_json = alone("msg", "list", "--interfaces", str(folder), "--json").output.splitlines()
    assert [json.loads(line) for line in as_json] == found


def test_package_lists_its_types(alone: Alone, folder: Path) -> None:
    assert alone("msg", "package", "rosgraph_msgs").output.splitlines() == [
        "rosgraph_msgs/Clock",
        "rosgraph_msgs/Log",
        "rosgraph_msgs/TopicStatistics",
    ]
    assert alone("msg", "package", "-s", "rosbridge_msgs").output == (
        "rosbridge_msgs/ConnectedClient rosbridge_msgs/ConnectedClients\n"
    )
    found = alone("msg", "package", "--interfaces", str(folder), "my_msgs")
    assert found.output == "my_msgs/Thing\n"
    result = alone("msg", "package", "std_msg")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "did you mean std_msgs?" in result.stderr


def test_packages_lists_packages_with_messages(alone: Alone) -> None:
    found = alone("msg", "packages").output.splitlines()
    assert found == sorted(found)
    assert "std_msgs" in found
    assert "std_srvs" not in found
    assert alone("msg", "packages", "-s").output == f"{' '.join(found)}\n"


def test_md5_is_that_of_ros_1(alone: Alone) -> None:
    md5 = "992ce8a1687cec8c8bd883ec73ca41d1"
    assert alone("msg", "md5", "std_msgs/String").output == f"{md5}\n"
    assert alone("msg", "md5", "String").output == f"[std_msgs/String]: {md5}\n"
    result = alone("msg", "md5", "std_msgs/Strin")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "std_msgs/Strin" in result.stderr
