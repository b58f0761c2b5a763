"""Replies to a client, and requests that others send it, while it reads and while it does not."""

from __future__ import annotations

import json

import pytest

from fibws.hub.errors import LimitReached
from fibws.hub.rosbridge.client import check_room
from fibws.hub.rosbridge.encodings import text_frame
from fibws.hub.settings import Settings

from ..fakes import TEXT, Client, FakeHub


def received(client: Client) -> list[bytes]:
    """Return the texts that have come, once the client reads."""
    client.queue.resume()
    frames = client.receive_frames()
    assert {first for first, _ in frames} <= {TEXT}
    return [payload for _, payload in frames]


@pytest.mark.parametrize("what", ["advertisements", "subscriptions", "calls", "goals"])
def test_limit_names_the_setting_that_raises_it(what: str) -> None:
    for taken in range(3):
        check_room(taken, 3, what)
    for taken in (3, 4):
        with pytest.raises(LimitReached, match=rf"limit 3, --max-{what}"):
            check_room(taken, 3, what)
    assert getattr(Settings(), f"max_{what}") > 0


def test_replies_are_never_dropped() -> None:
    client = FakeHub().client()
    client.queue.pause()
    for number in range(1000):
        client.session._client.reply(b"%d" % number)
    assert received(client) == [b"%d" % number for number in range(1000)]


def test_long_replies_are_fragmented_under_different_ids() -> None:
    client = FakeHub().client()
    for _ in range(2):
        client.session._client.reply(b'"a text"', 5)
        client.session._client.reply(b'"short"', 10)
    texts = received(client)
    pieces = [json.loads(text) for text in texts if b"fragment" in text]
    assert [each["data"] for each in pieces] == ['"a te', 'xt"'] * 2
    assert len({each["id"] for each in pieces}) == 2
    assert texts.count(b'"short"') == 2


def test_requests_of_others_leave_a_slow_client_room_for_its_own_replies() -> None:
    """Others may fill half of its queue, so that its own requests can still be answered."""
    client = FakeHub(max_queued_bytes=200).client()
    forward = client.session._client.forward_request
    assert forward(text_frame(b"x" * 1000))
    received(client)
    client.queue.pause()
    assert [forward(text_frame(b"x" * 40)) for _ in range(4)] == [True, True, False, False]
    assert not client.queue.overfull
    assert received(client) == [b"x" * 40] * 2
