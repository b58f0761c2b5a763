"""A hub that wants a token; the world's URL has one, which may use all names below /allowed."""

from __future__ import annotations

from typing import Any
from urllib.parse import parse_qs, urlsplit

import roslibpy

from .world import Collected, World


def token_in_the_url_lets_a_client_in(world: World) -> Any:
    return _echoed(world.connect(), "/url")


def token_in_a_header_lets_a_client_in(world: World) -> Any:
    parts = urlsplit(world.url)
    [token] = parse_qs(parts.query)["token"]
    headers = {"Authorization": f"Bearer {token}"}
    ros = roslibpy.Ros(parts._replace(query="").geturl(), headers=headers)
    ros.run()
    return _echoed(ros, "/header")


def _echoed(ros: Any, name: str) -> Any:
    """Return the message that a client receives from itself."""
    received = Collected()
    name = f"/allowed{name}"
    roslibpy.Topic(ros, name, "std_msgs/Int32").subscribe(received.put)
    roslibpy.Topic(ros, name, "std_msgs/Int32", latch=True).publish({"data": 8})
    return received.many(1)[0]
