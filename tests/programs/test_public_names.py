"""What `import fibws` gives."""

from __future__ import annotations

import asyncio
import sys
from typing import Any

import pytest
from running_programs import ROOT

import fibws
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String
from fibws.srv.std_srvs import Empty


async def test_public_names_are_loaded_on_first_use() -> None:
    code = (
        "import sys, fibws; before = set(sys.modules); fibws.Node; "
        "print('websockets' in before, 'pydantic' in before, 'asyncio' in before, "
        "'websockets' in sys.modules)"
    )
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", code, stdout=asyncio.subprocess.PIPE, cwd=ROOT
    )
    out, _ = await process.communicate()
    assert out == b"False False False True\n"


def test_all_public_names_exist() -> None:
    for name in fibws.__all__:
        assert getattr(fibws, name) is not None
    assert set(fibws.__all__) <= set(dir(fibws))
    with pytest.raises(AttributeError, match="Master"):
        fibws.Master  # type: ignore[attr-defined]  # noqa: B018


async def test_plain_with_and_for_are_answered_with_what_to_write(hub: HubServer) -> None:
    node: Any = fibws.Node("talker", hub=hub.url)
    with pytest.raises(TypeError, match="write async with, not with, for a Node"):
        with node:
            pass
    async with node:
        for loop in (node.subscribe("chatter", String), node.rate(10)):
            with pytest.raises(TypeError, match="write async for, not for, for a"):
                list(loop)


async def test_internal_names_are_not_suggested(hub: HubServer) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        publisher: Any = await node.advertise("chatter", String)
        service: Any = await node.service("reset", Empty, lambda request: {})
        for each in (node, publisher, service, node.params, node.graph, publisher.peers):
            assert [name for name in dir(each) if name[0] == "_" != name[1]] == []
        assert {"publish", "topic", "__aenter__"} <= {*dir(publisher)}
