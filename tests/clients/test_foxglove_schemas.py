"""Foxglove's parsers of messages with the schemas that the hub sends in Foxglove's protocol."""

from __future__ import annotations

from typing import Any

from .casts import playing

pytestmark = playing("foxglove_schemas")


def test_every_type_is_parsed_and_its_messages_are_decoded(seen: Any) -> None:
    assert seen["read"] == seen["types"] > 130


def test_publish_panel_reaches_another_client(seen: Any) -> None:
    none = {"x": 0, "y": 0, "z": 0}
    assert seen == {"linear": {**none, "x": 0.5}, "angular": {**none, "z": -1}}


def test_service_panel_reads_every_schema(seen: Any) -> None:
    assert seen == [{"type": "std_msgs/Bool", "fieldnames": ["data"]}]
