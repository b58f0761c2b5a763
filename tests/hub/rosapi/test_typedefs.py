"""The fields of types, as rosapi/TypeDef lists them."""

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
def user_types(tmp_path: Path) -> Interfaces:
    """Types with every kind of field and constant."""
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
    """The type definitions of a response, which fit rosapi's definition of them."""
    response = json.loads(text)
    assert list(response) == ["typedefs"]
    validate = Validators(Interfaces(), lambda: 0).of("rosapi/TypeDef").validate
    assert [validate(each) for each in response["typedefs"]] == response["typedefs"]
    found: list[dict[str, Any]] = response["typedefs"]
    return found


def types(text: bytes) -> list[str]:
    return [each["type"] for each in typedefs(text)]


def test_message_is_listed_with_the_types_in_it() -> None:
    assert typedefs(TypeDefs(Interfaces()).message("std_msgs/Header")) == [HEADER, TIME]


def test_types_are_listed_depth_first_and_once() -> None:
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


def test_every_kind_of_field_is_listed(user_types: Interfaces) -> None:
    everything, leaf, duration, time = typedefs(
        TypeDefs(user_types).message("user_msgs/Everything")
    )
    fields = zip(
        everything["fieldnames"],
        everything["fieldtypes"],
        everything["fieldarraylen"],
        everything["examples"],
        strict=True,
    )
    assert list(fields) == [
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


def test_constants_are_sorted_by_name(user_types: Interfaces) -> None:
    (leaf,) = typedefs(TypeDefs(user_types).message("user_msgs/Leaf"))
    assert leaf["constnames"] == ["A", "F", "M", "Z"]
    assert leaf["constvalues"] == ["some text", "2.0", "True", "-3"]


def test_requests_and_responses_of_a_service_are_listed(user_types: Interfaces) -> None:
    typedefs_of = TypeDefs(user_types)
    assert types(typedefs_of.request("user_msgs/Twice")) == [
        "user_msgs/TwiceRequest",
        "user_msgs/Leaf",
    ]
    assert types(typedefs_of.response("user_msgs/Twice")) == ["user_msgs/TwiceResponse", "time"]
    (request,) = typedefs(typedefs_of.request("rospy_tutorials/AddTwoInts"))
    assert request == {
        "type": "rospy_tutorials/AddTwoIntsRequest",
        "fieldnames": ["a", "b"],
        "fieldtypes": ["int64", "int64"],
        "fieldarraylen": [-1, -1],
        "examples": ["0", "0"],
        "constnames": [],
        "constvalues": [],
    }


def test_message_without_fields_is_listed(user_types: Interfaces) -> None:
    (empty,) = typedefs(TypeDefs(user_types).message("user_msgs/Empty"))
    assert (empty["type"], empty["fieldnames"], empty["examples"]) == ("user_msgs/Empty", [], [])


@pytest.mark.parametrize("name", ["int32", "string", "char", "bool"])
def test_builtin_type_has_an_empty_list(name: str) -> None:
    assert typedefs(TypeDefs(Interfaces()).message(name)) == []


@pytest.mark.parametrize("name", ["time", "duration"])
def test_time_and_duration_are_listed_like_messages(name: str) -> None:
    assert typedefs(TypeDefs(Interfaces()).message(name)) == [{**TIME, "type": name}]


def test_names_may_be_spelled_as_in_ros_2() -> None:
    typedefs_of = TypeDefs(Interfaces())
    assert typedefs_of.message("std_msgs/msg/Header") is typedefs_of.message("std_msgs/Header")
    assert typedefs_of.request("std_srvs/srv/SetBool") is typedefs_of.request("std_srvs/SetBool")
    assert typedefs_of.response("std_srvs/srv/SetBool") is typedefs_of.response("std_srvs/SetBool")


@pytest.mark.parametrize("name", ["", "Header", "std_msgs/Sting", "nowhere_msgs/Thing"])
def test_unknown_type_is_an_error(name: str) -> None:
    typedefs_of = TypeDefs(Interfaces())
    for details in (typedefs_of.message, typedefs_of.request, typedefs_of.response):
        with pytest.raises(InterfaceError):
            details(name)


@pytest.mark.long
def test_every_standard_type_can_be_listed() -> None:
    interfaces = Interfaces()
    typedefs_of = TypeDefs(interfaces)
    for package in interfaces.packages():
        for name in interfaces.messages(package):
            assert types(typedefs_of.message(name))[0] == name
        for name in interfaces.services(package):
            assert types(typedefs_of.request(name))[0] == f"{name}Request"
            assert types(typedefs_of.response(name))[0] == f"{name}Response"
