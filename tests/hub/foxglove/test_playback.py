"""Control of a bag's player."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from fibws.access.rights import Principal, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.foxglove.messages import PlaybackRequest, parse_binary

from ..fakes import Client, finish
from .foxglove_client import FoxgloveClient, FoxgloveHub

STATE = """\
uint8 PLAYING=1
uint8 PAUSED=2
uint8 DELAYED=3
uint8 ENDED=4
uint8 status
time start
time end
time position
float64 rate
string[] bags
"""
CONTROL = f"""\
string command
time position
float64 rate
---
bool success
string message
PlaybackState state
{"=" * 80}
MSG: fibws_msgs/PlaybackState
{STATE}"""
ADMIN = Principal("admin", Rights(admin=True))


def state(status: int = 1, position: int = 15, rate: float = 1.0) -> dict[str, Any]:
    return {
        "status": status,
        "start": {"secs": 10, "nsecs": 1},
        "end": {"secs": 20, "nsecs": 2},
        "position": {"secs": position, "nsecs": 0},
        "rate": rate,
        "bags": ["walk.bag"],
    }


class Player:
    """A node that plays a bag, as `fibws bag play` does."""

    def __init__(self, hub: FoxgloveHub, node: str = "/play") -> None:
        principal = None if hub.graph.policy.allows_all else ADMIN
        self.client: Client = hub.client(node, principal=principal)
        self.name = node
        self.commands: list[dict[str, Any]] = []
        self.client.send(
            "advertise_service",
            service=f"{node}/control_playback",
            type="fibws_msgs/ControlPlayback",
            definition=CONTROL,
        )
        self.client.send(
            *("advertise", f"{node}/playback"),
            type="fibws_msgs/PlaybackState",
            definition=STATE,
            latch=True,
        )
        self.publish()

    def publish(self, **fields: Any) -> None:
        self.client.send("publish", f"{self.name}/playback", msg=state(**fields))

    def answer(self, fault: str = "", **fields: Any) -> list[dict[str, Any]]:
        """Answer all calls that have come; return them."""
        calls = [each for each in self.client.receive() if each["op"] == "call_service"]
        for call in calls:
            values = {"success": not fault, "message": fault, "state": state(**fields)}
            self.client.send(
                *("service_response",),
                service=call["service"],
                id=call["id"],
                result=True,
                values=values,
            )
        return [call["args"] for call in calls]


def control(
    client: FoxgloveClient, command: int, speed: float = 1.0, seek: int | None = None
) -> None:
    id_ = b"request"
    head = (3, command, speed, seek is not None, seek or 0, len(id_))
    client.send_binary(struct.pack("<BBfBQI", *head) + id_)


def states(client: FoxgloveClient) -> list[tuple[int, int, float, bool, str]]:
    """Return status, seconds, speed, whether it is after a seek, and request of what came."""
    found = []
    for each in client.receive():
        assert isinstance(each, bytes), each
        kind, status, time, speed, did_seek, size = struct.unpack_from("<BBQfBI", each)
        assert kind == 5
        assert len(each) == 19 + size
        found.append((status, time // 10**9, speed, bool(did_seek), each[19:].decode()))
    return found


@pytest.mark.parametrize("is_early", [True, False])
def test_player_gives_the_hub_a_range_of_time(is_early: bool) -> None:
    hub = FoxgloveHub()
    if is_early:
        player, client = Player(hub), hub.foxglove_client()
    else:
        client = hub.foxglove_client()
        client.receive()
        assert "playbackControl" not in client.info["capabilities"]
        player = Player(hub)
    assert states(client) == [(0, 15, 1.0, False, "")]
    assert "playbackControl" in client.info["capabilities"]
    assert client.info["dataStartTime"] == {"sec": 10, "nsec": 1}
    assert client.info["dataEndTime"] == {"sec": 20, "nsec": 2}
    for status in (2, 3, 4):
        player.publish(status=status, position=status)
    assert states(client)[-1] == (3, 4, 1.0, False, "")
    player.client.disconnect()
    client.receive()
    assert "playbackControl" not in client.info["capabilities"]
    assert "dataStartTime" not in client.info


def test_client_pauses_and_seeks_and_changes_the_speed() -> None:
    hub = FoxgloveHub()
    player, client = Player(hub), hub.foxglove_client()
    client.receive()
    control(client, 1)
    [command] = player.answer(status=2)
    assert command["command"] == "pause"
    assert states(client) == [(1, 15, 1.0, False, "request")]
    control(client, 0, speed=0.1, seek=12 * 10**9 + 5)
    rate, seek, play = player.answer(position=12, rate=0.5)
    assert (rate["command"], rate["rate"]) == ("rate", 0.1)
    assert (seek["command"], seek["position"]) == ("seek", {"secs": 12, "nsecs": 5})
    assert play["command"] == "play"
    assert states(client) == [(0, 12, 0.5, True, "request")]
    control(client, 0, speed=0.5)
    assert [each["command"] for each in player.answer(rate=1e300)] == ["play"]
    [(_, _, speed, _, _)] = states(client)
    assert speed == pytest.approx(3e38)


def test_fault_of_the_player_is_a_status() -> None:
    hub = FoxgloveHub(service_timeout=2.0)
    player, client = Player(hub), hub.foxglove_client()
    client.receive()
    control(client, 0)
    player.answer("it cannot")
    status, _ = client.receive()
    assert isinstance(status, dict)
    assert (status["level"], "it cannot" in status["message"]) == (2, True)
    control(client, 0, speed=-1.0)
    [text] = client.receive_statuses()
    assert "speed" in text
    control(client, 0)
    hub.clock.advance(3)
    status, _ = client.receive()
    assert isinstance(status, dict)
    assert "2 s" in status["message"]


def test_player_with_other_fields_is_none() -> None:
    hub = FoxgloveHub()
    other = hub.client("/play")
    type_ = "fibws_msgs/ControlPlayback"
    service = "/play/control_playback"
    other.send("advertise_service", service=service, type=type_, definition="---\n")
    definition = "string status\ntime start\ntime end"
    type_ = "fibws_msgs/PlaybackState"
    other.send("advertise", "/play/playback", type=type_, definition=definition)
    client = hub.foxglove_client()
    other.send("publish", "/play/playback", msg={"status": "playing"})
    assert client.receive() == []
    assert "playbackControl" not in client.info["capabilities"]


def test_state_with_too_many_values_is_ignored(caplog: pytest.LogCaptureFixture) -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    player = Player(hub)
    client.receive()
    count = 4_000_000
    bags = struct.pack("<I", count) + bytes(4 * count)
    source = hub.graph.topics["/play/playback"].sources[player.name]
    source.publish_serialized(struct.pack("<BIIIIIId", 1, 30, 0, 40, 0, 35, 0, 1.0) + bags)
    client.receive()
    assert client.info["dataStartTime"] == {"sec": 10, "nsec": 1}
    assert "a subscriber failed" not in caplog.text


def test_without_a_player_control_is_an_error() -> None:
    client = FoxgloveHub().foxglove_client()
    control(client, 0)
    [text] = client.receive_statuses()
    assert "no bag is played" in text


def test_another_player_is_used_once_the_first_one_has_left() -> None:
    hub = FoxgloveHub()
    first, second = Player(hub, "/a_play"), Player(hub, "/b_play")
    client = hub.foxglove_client()
    client.receive()
    assert client.session.subscribing() == {"/a_play/playback"}
    first.client.disconnect()
    client.receive()
    control(client, 1)
    assert len(second.answer()) == 1
    control(client, 1)
    client.disconnect()
    second.answer()
    second.client.disconnect()
    assert hub.empty


def test_player_needs_the_rights_to_call_and_subscribe() -> None:
    hub = FoxgloveHub(policy=AccessPolicy())
    player = Player(hub)
    fewer = Rights({"subscribe": ["/play/playback"]})
    more = Rights({"subscribe": ["/play/playback"], "call": ["/play/*"]})
    client = hub.foxglove_client(None, principal=Principal("guest", fewer))
    assert client.receive() == []
    finish(client.session.authorize(Principal("guest", more)))
    assert len(states(client)) == 1
    finish(client.session.authorize(Principal("guest", fewer)))
    client.receive()
    assert "playbackControl" not in client.info["capabilities"]
    player.publish()
    assert client.receive() == []


def test_request_is_read() -> None:
    data = struct.pack("<BBfBQI", 3, 1, 0.5, 1, 7, 2) + b"id"
    assert parse_binary(data) == PlaybackRequest(True, 0.5, 7, "id")
    data = struct.pack("<BBfBQI", 3, 0, 1.0, 0, 7, 0)
    assert parse_binary(data) == PlaybackRequest(False, 1.0, None, "")
