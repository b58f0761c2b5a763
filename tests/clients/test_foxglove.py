"""Foxglove's rosbridge client with the hub."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("foxglove")


HEADER = {"seq": 1, "stamp": {"sec": 5, "nsec": 6}}


def test_ros_version_is_detected_by_the_topics(seen: Any) -> None:
    assert seen == 1


def test_every_type_is_parsed_and_its_messages_are_decoded(seen: Any) -> None:
    assert seen["read"] == seen["types"] > 130


def test_unknown_type_does_not_affect_others(seen: Any) -> None:
    assert seen == {"data": True}


def test_number_is_decoded(seen: Any) -> None:
    assert seen == {"data": -(2**31)}


def test_pose_with_covariance_is_decoded(seen: Any) -> None:
    assert seen == {
        "header": {**HEADER, "frame_id": "map"},
        "pose": {
            "pose": {
                "position": {"x": 1.5, "y": -2, "z": 0},
                "orientation": {"x": 0, "y": 0, "z": 0, "w": 1},
            },
            "covariance": {"Float64Array": [index / 8 for index in range(36)]},
        },
    }


def test_image_is_decoded(seen: Any) -> None:
    assert seen == {
        "header": {**HEADER, "frame_id": "camera"},
        "height": 1,
        "width": 2,
        "encoding": "rgb8",
        "is_bigendian": 0,
        "step": 6,
        "data": {"Uint8Array": [255, 0, 1, 2, 3, 254]},
    }


def test_points_are_decoded(seen: Any) -> None:
    assert seen == {
        "header": {**HEADER, "frame_id": "lidar"},
        "height": 1,
        "width": 1,
        "fields": [{"name": "x", "offset": 0, "datatype": 7, "count": 1}],
        "is_bigendian": False,
        "point_step": 4,
        "row_step": 4,
        "data": {"Uint8Array": [0, 0, 128, 63]},
        "is_dense": True,
    }


def test_graph_is_drawn_from_every_node(seen: Any) -> None:
    assert seen == {
        "robot": {
            "subscriptions": ["/robot/command"],
            "publications": ["/robot/number"],
            "services": [],
        },
        "log": ["/rosout"],
    }


def test_publish_panel_reaches_the_robot(seen: Any) -> None:
    none = {"x": 0, "y": 0, "z": 0}
    assert seen == {"linear": {**none, "x": 0.5}, "angular": {**none, "z": -1}}


def test_service_panel_calls_a_service_by_its_type(seen: Any) -> None:
    assert seen == {"success": True, "message": "on"}


def test_new_topic_is_found_by_the_next_poll(seen: Any) -> None:
    assert seen == {"before": False, "after": True}
