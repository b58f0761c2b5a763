"""What ROS 2 nodes may not see looks absent: they see the same tokens, and get the same answers."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from pathlib import Path

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String
from fibws.srv.example_interfaces import AddTwoInts

from .conftest import StartRos2Hub
from .peer import Peer
from .test_robustness import start_with_rights
from .test_services import request
from .test_topics import until_tokens

ALLOW = (
    'publish = ["/open/**", "/half/out"], subscribe = ["/open/**", "/half/in"],'
    ' call = ["/open/**"], node = ["/robot/**"]'
)
TOPICS = ("/hid/topic", "/hid/cmd", "/half/in", "/half/out")
ATTACHMENT = bytes(16) + b"\x10" + bytes(16)


async def seen(
    start_ros2_hub: StartRos2Hub, path: Path, stack: AsyncExitStack, *, is_there: bool
) -> list[str]:
    """Return all that a ROS 2 program sees of a hub on which a hidden node is, or is not."""
    hub, endpoint, admin = await start_with_rights(start_ros2_hub, path, ALLOW)
    peer = await stack.enter_async_context(Peer(endpoint))
    tokens, changed = await tokens_with_ids(peer, hub)
    for topic in TOPICS:
        await peer.publisher("/robot/node", topic)
        await peer.subscriber("/robot/node", topic)
    if is_there:
        arm = await stack.enter_async_context(
            fibws.Node("arm", namespace="/hid", hub=hub.url, token=admin)
        )
        await arm.advertise("topic", String, latch=True)
        arm.subscribe("cmd", String)
        await arm.advertise("/half/out", String)
        arm.subscribe("/half/in", String)
        await arm.service("srv", AddTwoInts, lambda request: {"sum": 0})
    reply = await peer.call("/hid/srv", request(1, 1), ATTACHMENT)
    ours = await stack.enter_async_context(fibws.Node("ours", hub=hub.url, token=admin))
    await ours.advertise("/open/mark", String)
    await until_tokens(changed, lambda: any("%open%mark/" in token for token in tokens))
    return [str(reply), *sorted(tokens)]


async def tokens_with_ids(peer: Peer, hub: HubServer) -> tuple[set[str], asyncio.Event]:
    """Return the tokens of a hub, without that of the session, and what is set when they change."""
    tokens: set[str] = set()
    changed = asyncio.Event()
    assert hub.ros2 is not None
    own = hub.ros2.network.session_id

    def note(text: str, is_alive: bool) -> None:
        if own in text:
            (tokens.add if is_alive else tokens.discard)(text.replace(own, "HUB"))
            changed.set()

    await peer.tokens(note)
    return tokens, changed


async def test_hidden_names_look_absent(start_ros2_hub: StartRos2Hub, tmp_path: Path) -> None:
    answers = list[list[str]]()
    for is_there in (True, False):
        path = tmp_path / f"tokens_{is_there}.toml"
        async with AsyncExitStack() as stack:
            answers.append(await seen(start_ros2_hub, path, stack, is_there=is_there))
    hidden, absent = answers
    assert hidden == absent
    assert any("mark" in each for each in hidden)
