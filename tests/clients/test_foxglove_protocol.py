"""`FoxgloveClient` of @foxglove/ws-protocol with the hub."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("foxglove_protocol")


def test_server_introduces_itself(seen: Any) -> None:
    assert seen["supportedEncodings"] == ["ros1", "json"]
    assert seen["metadata"] == {"ROS_DISTRO": "noetic"}
    assert {
        *("clientPublish", "connectionGraph", "parameters", "parametersSubscribe", "services")
    } <= {*seen["capabilities"]}


def test_topic_of_another_client_is_a_channel(seen: Any) -> None:
    assert seen == {
        "id": "number",
        "topic": "/robot/number",
        "encoding": "ros1",
        "schemaName": "std_msgs/Int32",
        "schemaEncoding": "ros1msg",
        "schema": "int32 data\n",
    }


def test_message_arrives_with_its_time(seen: Any) -> None:
    assert seen == {"subscription": True, "time": True, "data": -5}


def test_json_is_serialized(seen: Any) -> None:
    assert bytes(seen) == b"\2\0\0\0hi"


def test_nothing_comes_after_the_subscription(seen: Any) -> None:
    assert seen == {"received": 0, "removed": 1}


def test_service_is_called_in_both_encodings(seen: Any) -> None:
    assert seen == {"time": ["ros1", 8, True], "type": ["json", {"type": "rosapi/GetTime"}]}


def test_failing_call_says_why(seen: Any) -> None:
    assert seen == {"callId": 9, "message": "string"}


def test_parameters_are_set_and_read_and_followed(seen: Any) -> None:
    limit = {"name": "/robot/speed_limit", "value": 2, "type": "float64"}
    names = {"name": "/robot/names", "value": ["a", "b"]}
    blob = {"name": "/robot/blob", "value": "AP8=", "type": "byte_array"}
    assert seen["set"] == [limit, names, blob]
    assert sorted(seen["read"], key=str) == sorted([limit, names, blob], key=str)
    assert seen["updates"] == [[limit], [{"name": "/robot/speed_limit"}]]


def test_connection_graph_is_followed(seen: Any) -> None:
    assert seen == [{"name": "/graph/number", "publisherIds": ["/graph_robot"]}, "removed"]


def test_unknown_channel_is_an_error(seen: Any) -> None:
    assert seen["level"] == 2
    assert "99999" in seen["message"]


def test_unknown_asset_is_an_error(seen: Any) -> None:
    assert seen == {"requestId": 7, "status": 1, "error": "string"}
