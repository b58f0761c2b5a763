"""Which types there are, and what is in them."""

from __future__ import annotations

import pytest
import rosmsg

from ..conftest import Define

HEADER = "uint32 seq\ntime stamp\nstring frame_id\n"


def test_types_are_listed(define: Define) -> None:
    define("robot/Arm", "int32 joints  # how many\n")
    assert rosmsg.list_msgs("robot") == ["robot/Arm"]
    assert "std_srvs/SetBool" in rosmsg.list_srvs("std_srvs")
    assert rosmsg.list_types("nowhere") == []
    with pytest.raises(rosmsg.ROSMsgException, match="Invalid mode"):
        rosmsg.list_types("std_msgs", "msg")


def test_definitions_are_shown(define: Define) -> None:
    define("robot/Arm", "int32 joints  # how many\n")
    assert rosmsg.get_msg_text("std_msgs/Header") == HEADER
    assert rosmsg.get_msg_text("robot/Arm") == "int32 joints\n"
    assert rosmsg.get_msg_text("robot/Arm", raw=True) == "int32 joints  # how many\n"
    assert rosmsg.get_srv_text("std_srvs/Trigger") == "---\nbool success\nstring message\n"


@pytest.mark.parametrize("type_", ["robot/Leg", "std_msgs/Strng", "String"])
def test_unknown_types_are_errors(type_: str) -> None:
    with pytest.raises(rosmsg.ROSMsgException, match=f"Unable to load msg .{type_}"):
        rosmsg.get_msg_text(type_)


def test_packages_are_listed_with_their_folders() -> None:
    found = dict(rosmsg.iterate_packages(None, rosmsg.MODE_SRV))
    assert found["std_srvs"].endswith("/srv")
    assert "std_msgs" not in found
