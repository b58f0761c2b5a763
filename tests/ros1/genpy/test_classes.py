"""Message and service classes are made of definitions, one for each type."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from genpy.classes import forget, message_class, service_class
from genpy.message import get_message_class, get_service_class
from genpy.rostime import Duration, Time

import fibws
from fibws.errors import DefinitionError, UnknownType

from ..conftest import Define


def test_node_library_accepts_the_classes() -> None:
    assert issubclass(message_class("std_msgs/Int32"), fibws.Message)
    service: Any = service_class("rospy_tutorials/AddTwoInts")
    assert issubclass(service, fibws.Service)
    assert service.Request is service._request_class
    assert service.Response is service._response_class


def test_type_has_the_same_class_under_all_its_names() -> None:
    assert message_class("std_msgs/msg/Int32") is message_class("std_msgs/Int32")


def test_threads_get_the_same_class() -> None:
    forget(["visualization_msgs"])
    with ThreadPoolExecutor(8) as pool:
        found = set(pool.map(message_class, ["visualization_msgs/MarkerArray"] * 8))
    assert len(found) == 1


def test_service_class_has_type_and_md5() -> None:
    service: Any = service_class("rospy_tutorials/AddTwoInts")
    assert service._type == "rospy_tutorials/AddTwoInts"
    assert service._md5sum == "6a2e34150c00229791cc89ff309fff21"
    request, response = service._request_class, service._response_class
    assert (request._type, request.__slots__) == ("rospy_tutorials/AddTwoIntsRequest", ["a", "b"])
    assert response._full_text == "int64 sum\n"
    assert request._md5sum == "36d09b846be0b371c5f190354dd3153e"
    assert request.__module__ == "rospy_tutorials.srv._AddTwoInts"


def test_defaults_of_ros_2_are_applied(define: Define) -> None:
    define("fibonacci/Num", "int64 num 5\nint64[] list [1, 2]\nuint8[2] data [3, 4]\nstring s 'a'")
    message: Any = message_class("fibonacci/Num")()
    assert (message.num, message.list, message.data, message.s) == (5, [1, 2], b"\3\4", "a")
    assert message is not message_class("fibonacci/Num")()
    message.list.append(3)
    assert message_class("fibonacci/Num")().to_dict()["list"] == [1, 2]


def test_error_names_the_invalid_definition(define: Define) -> None:
    path = define("fibonacci/Num", "int33 num")
    with pytest.raises(DefinitionError, match=str(path)):
        message_class("fibonacci/Num")
    with pytest.raises(UnknownType):
        service_class("std_srvs/Emty")


def test_classes_are_found_by_type_names() -> None:
    assert get_message_class("std_msgs/Int32") is message_class("std_msgs/Int32")
    assert get_message_class("Header") is message_class("std_msgs/Header")
    assert get_message_class("time") is Time
    assert get_message_class("duration") is Duration
    assert get_service_class("std_srvs/Empty") is service_class("std_srvs/Empty")
    assert get_message_class("std_msgs/Int23") is None
    assert get_message_class("my_msgs/Int32", reload_on_error=True) is None
    assert get_service_class("std_srvs/Emty") is None
    with pytest.raises(ValueError, match="message type is missing package name: Int32"):
        get_message_class("Int32")


def test_unknown_field_is_answered_with_the_nearest() -> None:
    transform: Any = message_class("geometry_msgs/TransformStamped")
    with pytest.raises(AttributeError, match="did you mean child_frame_id"):
        transform(child_frame="base")
