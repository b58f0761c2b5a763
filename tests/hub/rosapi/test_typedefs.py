"""What types are made of, as rosapi's TypeDefs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from fibws.errors import InterfaceError
from fibws.hub.rosapi.typedefs import TypeDefs
from fibws.interfaces import Interfaces, Validators

TIME = {
    "type": "time",
    "fieldnames": ["secs", "nsecs"],
    "fieldtypes": ["int32", "int32"],
    "fieldarraylen": [-1, -1],
    "examples": ["0", "0"],
    "constnames": [],
    "constvalues": [],
}
HEADER = {
    "type": "std_msgs/Header",
    "fieldnames": ["seq", "stamp", "frame_id"],
    "fieldtypes": ["uint32", "time", "string"],
    "fieldarraylen": [-1, -1, -1],
    "examples": ["0", "{}", ""],
    "constnames": [],
    "constvalues": [],
}


@pytest.fixture
def users(tmp_path: Path) -> Interfaces:
    """Types with all that a definition can have."""
    files = {
        "msg/Everything.msg": "bool b\nbyte o\nchar c\nfloat32 f\nfloat64[] d\nuint8[4] u\n"
        "string s\nLeaf[<=3] leaves\nLeaf leaf\nduration d1\ntime[2] t\nwstring w\n"
        "string<=5 short\n",
        "msg/Leaf.msg": "int32 Z=-3\nstring A=some text\nbool M=True\nfloat32 F=2\nint8 x 7\n",
        "msg/Empty.msg": "",
        "srv/Twice.srv": "Leaf a\nLeaf b\n---\ntime when\n",
    }
    for name, text in files.items():
        path = tmp_path / "user_msgs" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return Interfaces([tmp_path])


def typedefs(text: bytes) -> list[dict[str, Any]]:
    """What a response tells, which fits rosapi's own definition of it."""
    response = json.loads(text)
    assert list(response) == ["typedefs"]
    validate = Validators(Interfaces(), lambda: 0).of("rosapi/TypeDef").validate
    assert [validate(each) for each in response["typedefs"]] == response["typedefs"]
    found: list[dict[str, Any]] = response["typedefs"]
    return found


def types(text: bytes) -> list[str]:
    return [each["type"] for each in typedefs(text)]


def test_a_message_is_told_with_the_types_in_it() -> None:
    assert typedefs(TypeDefs(Interfaces()).message("std_msgs/Header")) == [HEADER, TIME]


def test_types_come_depth_first_each_once() -> None:
    assert types(TypeDefs(Interfaces()).message("geometry_msgs/PoseWithCovarianceStamped")) == [
        "geometry_msgs/PoseWithCovarianceStamped",
        "std_msgs/Header",
        "time",
        "geometry_msgs/PoseWithCovariance",
        "geometry_msgs/Pose",
        "geometry_msgs/Point",
        "geometry_msgs/Quaternion",
    ]
    assert types(TypeDefs(Interfaces()).message("geometry_msgs/Twist")) == [
        "geometry_msgs/Twist",
        "geometry_msgs/Vector3",
    ]


def test_every_kind_of_field_is_told(users: Interfaces) -> None:
    everything, leaf, duration, time = typedefs(TypeDefs(users).message("user_msgs/Everything"))
    told = zip(
        everything["fieldnames"],
        everything["fieldtypes"],
        everything["fieldarraylen"],
        everything["examples"],
        strict=True,
    )
    assert list(told) == [
        ("b", "bool", -1, "False"),
        ("o", "byte", -1, "0"),
        ("c", "char", -1, "0"),
        ("f", "float32", -1, "0.0"),
        ("d", "float64", 0, "[]"),
        ("u", "uint8", 4, "[]"),
        ("s", "string", -1, ""),
        ("leaves", "user_msgs/Leaf", 0, "[]"),
        ("leaf", "user_msgs/Leaf", -1, "{}"),
        ("d1", "duration", -1, "{}"),
        ("t", "time", 2, "[]"),
        ("w", "string", -1, ""),
        ("short", "string", -1, ""),
    ]
    assert (leaf["type"], leaf["fieldnames"], leaf["examples"]) == ("user_msgs/Leaf", ["x"], ["7"])
    assert duration == {**TIME, "type": "duration"}
    assert time == TIME


def test_constants_are_sorted_by_name(users: Interfaces) -> None:
    (leaf,) = typedefs(TypeDefs(users).message("user_msgs/Leaf"))
    assert leaf["constnames"] == ["A", "F", "M", "Z"]
    assert leaf["constvalues"] == ["some text", "2.0", "True", "-3"]


def test_a_service_is_told_by_its_request_and_its_response(users: Interfaces) -> None:
    told = TypeDefs(users)
    assert types(told.request("user_msgs/Twice")) == ["user_msgs/TwiceRequest", "user_msgs/Leaf"]
    assert types(told.response("user_msgs/Twice")) == ["user_msgs/TwiceResponse", "time"]
    (request,) = typedefs(told.request("rospy_tutorials/AddTwoInts"))
    assert request == {
        "type": "rospy_tutorials/AddTwoIntsRequest",
        "fieldnames": ["a", "b"],
        "fieldtypes": ["int64", "int64"],
        "fieldarraylen": [-1, -1],
        "examples": ["0", "0"],
        "constnames": [],
        "constvalues": [],
    }


def test_what_has_no_fields_is_told_all_the_same(users: Interfaces) -> None:
    (empty,) = typedefs(TypeDefs(users).message("user_msgs/Empty"))
    assert (empty["type"], empty["fieldnames"], empty["examples"]) == ("user_msgs/Empty", [], [])


@pytest.mark.parametrize("name", ["int32", "string", "char", "bool"])
def test_a_plain_value_is_made_of_nothing(name: str) -> None:
    assert typedefs(TypeDefs(Interfaces()).message(name)) == []


@pytest.mark.parametrize("name", ["time", "duration"])
def test_times_are_told_as_if_they_were_messages(name: str) -> None:
    assert typedefs(TypeDefs(Interfaces()).message(name)) == [{**TIME, "type": name}]


def test_names_may_be_spelled_as_in_ros_2() -> None:
    told = TypeDefs(Interfaces())
    assert told.message("std_msgs/msg/Header") is told.message("std_msgs/Header")
    assert told.request("std_srvs/srv/SetBool") is told.request("std_srvs/SetBool")
    assert told.response("std_srvs/srv/SetBool") is told.response("std_srvs/SetBool")


@pytest.mark.parametrize("name", ["", "Header", "std_msgs/Sting", "nowhere_msgs/Thing"])
def test_what_nobody_defined_is_an_error(name: str) -> None:
    told = TypeDefs(Interfaces())
    for tell in (told.message, told.request, told.response):
        with pytest.raises(InterfaceError):
            tell(name)


def test_every_standard_type_can_be_told() -> None:
    interfaces = Interfaces()
    told = TypeDefs(interfaces)
    for package in interfaces.packages():
        for name in interfaces.messages(package):
            assert types(told.message(name))[0] == name
        for name in interfaces.services(package):
            assert types(told.request(name))[0] == f"{name}Request"
            assert types(told.response(name))[0] == f"{name}Response"
