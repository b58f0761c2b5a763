"""Definitions of installed types and of files; their parts are compared side by side."""

from __future__ import annotations

from pathlib import Path

import pytest
import roslib


def test_installed_type_is_found_by_name() -> None:
    type_, spec = roslib.msgs.load_by_type("Point", "geometry_msgs")
    assert type_ == "geometry_msgs/Point"
    assert spec.fields() == [("float64", "x"), ("float64", "y"), ("float64", "z")]
    assert "Point" in roslib.msgs.list_msg_types("geometry_msgs")
    with pytest.raises(roslib.msgs.MsgSpecException, match="nothing/Here"):
        roslib.msgs.load_by_type("nothing/Here")


def test_definition_is_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "Arm.msg"
    path.write_text("Joint[2] joints\n")
    assert roslib.msgs.load_from_file(str(path), "robot")[0] == "robot/Arm"
    assert roslib.msgs.load_from_file(str(path), "robot")[1].types == ["robot/Joint[2]"]
    path.write_text("Joint\n")
    with pytest.raises(roslib.msgs.MsgSpecException, match=r"Arm\.msg"):
        roslib.msgs.load_from_file(str(path))


def test_service_has_two_parts(tmp_path: Path) -> None:
    path = tmp_path / "Move.srv"
    path.write_text("int32 x\n---\nbool ok\n")
    type_, spec = roslib.srvs.load_from_file(str(path), "robot")
    assert (type_, spec.request.names, spec.response.names) == ("robot/Move", ["x"], ["ok"])
    with pytest.raises(roslib.srvs.SrvSpecException, match="---"):
        roslib.srvs.load_from_string("int32 x\n")
