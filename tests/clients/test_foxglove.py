"""What Foxglove does with the hub."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("foxglove")


HEADER = {"seq": 1, "stamp": {"sec": 5, "nsec": 6}}


def test_the_version_of_ROS_is_told_by_the_topics(seen: Any) -> None:
    assert seen == 1


def test_every_type_is_parsed_and_its_messages_are_read(seen: Any) -> None:
    assert seen["read"] == seen["types"] > 130


def test_a_type_that_nobody_defined_keeps_no_other_from_being_read(seen: Any) -> None:
    assert seen == {"data": True}


def test_a_number_is_read(seen: Any) -> None:
    assert seen == {"data": -(2**31)}


def test_a_pose_with_its_covariance_is_read(seen: Any) -> None:
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


def test_an_image_is_read(seen: Any) -> None:
    assert seen == {
        "header": {**HEADER, "frame_id": "camera"},
        "height": 1,
        "width": 2,
        "encoding": "rgb8",
        "is_bigendian": 0,
        "step": 6,
        "data": {"Uint8Array": [255, 0, 1, 2, 3, 254]},
    }


def test_points_are_read(seen: Any) -> None:
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


def test_the_graph_is_drawn_from_every_node(seen: Any) -> None:
    assert seen == {
        "robot": {
            "subscriptions": ["/robot/command"],
            "publications": ["/robot/number"],
            "services": [],
        },
        "log": ["/rosout"],
    }


def test_the_panel_for_publishing_reaches_the_robot(seen: Any) -> None:
    none = {"x": 0, "y": 0, "z": 0}
    assert seen == {"linear": {**none, "x": 0.5}, "angular": {**none, "z": -1}}


def test_the_panel_for_services_calls_one_by_the_type_it_is_told(seen: Any) -> None:
    assert seen == {"success": True, "message": "on"}


def test_the_next_round_of_asking_finds_a_new_topic(seen: Any) -> None:
    assert seen == {"before": False, "after": True}
