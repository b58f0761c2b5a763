"""Introspection of the graph by each client."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("introspection")


def test_topics_and_their_types_are_listed(seen: Any) -> None:
    assert seen == {
        "number": "std_msgs/Int16",
        "text": "std_msgs/String",
        "log": "rosgraph_msgs/Log",
    }


def test_topics_can_be_found_by_type_and_types_by_topic(seen: Any) -> None:
    assert seen == {"topics": ["/found/number"], "type": "std_msgs/Int16", "none": ""}


def test_services_can_be_listed_and_found_by_type_and_types_by_service(seen: Any) -> None:
    assert seen == {
        "listed": ["/served/switch"],
        "ours": True,
        "found": ["/served/switch"],
        "type": "std_srvs/SetBool",
        "none": "",
    }


def test_nodes_are_listed_with_their_details(seen: Any) -> None:
    assert seen == {
        "nodes": [True, True, True],
        "subscribing": ["/looked_into/text"],
        "publishing": ["/looked_into/number"],
        "services": ["/looked_into/switch"],
    }


def test_message_type_is_described_field_by_field(seen: Any) -> None:
    assert seen["fix"] == {
        "type": "sensor_msgs/NavSatFix",
        "fieldnames": [
            *("header", "status", "latitude", "longitude", "altitude"),
            *("position_covariance", "position_covariance_type"),
        ],
        "fieldtypes": [
            *("std_msgs/Header", "sensor_msgs/NavSatStatus", "float64", "float64", "float64"),
            *("float64", "uint8"),
        ],
        "fieldarraylen": [-1, -1, -1, -1, -1, 9, -1],
        "examples": ["{}", "{}", "0.0", "0.0", "0.0", "[]", "0"],
        "constnames": [
            "COVARIANCE_TYPE_APPROXIMATED",
            "COVARIANCE_TYPE_DIAGONAL_KNOWN",
            "COVARIANCE_TYPE_KNOWN",
            "COVARIANCE_TYPE_UNKNOWN",
        ],
        "constvalues": ["1", "2", "3", "0"],
    }
    assert seen["pose"] == [
        *("geometry_msgs/PoseStamped", "std_msgs/Header", "time"),
        *("geometry_msgs/Pose", "geometry_msgs/Point", "geometry_msgs/Quaternion"),
    ]


def test_service_type_is_described_field_by_field(seen: Any) -> None:
    both: dict[str, list[str]] = {"constnames": [], "constvalues": []}
    assert seen == {
        "request": [
            {
                "type": "rospy_tutorials/AddTwoIntsRequest",
                "fieldnames": ["a", "b"],
                "fieldtypes": ["int64", "int64"],
                "fieldarraylen": [-1, -1],
                "examples": ["0", "0"],
                **both,
            }
        ],
        "response": [
            {
                "type": "rospy_tutorials/AddTwoIntsResponse",
                "fieldnames": ["sum"],
                "fieldtypes": ["int64"],
                "fieldarraylen": [-1],
                "examples": ["0"],
                **both,
            }
        ],
    }


def test_all_definitions_are_returned_at_once(seen: Any) -> None:
    assert seen == {"type": "std_msgs/Int16", "number": "int16 data", "log": True}
