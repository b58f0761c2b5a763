"""Types as trees, decoded by roslib in JavaScript."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("typedefs")


HEADER = {"seq": "uint32", "stamp": "time", "frame_id": "string"}


def test_message_type_is_decoded_into_a_tree(seen: Any) -> None:
    point = dict.fromkeys("xyz", "float64")
    assert seen == {
        "header": HEADER,
        "pose": {"position": point, "orientation": {**point, "w": "float64"}},
    }


def test_message_type_with_arrays_of_messages_is_decoded_into_a_tree(seen: Any) -> None:
    goal_id = {"stamp": "time", "id": "string"}
    assert seen == {
        "header": HEADER,
        "status_list": [{"goal_id": goal_id, "status": "uint8", "text": "string"}],
    }
