"""rostopic's functions for scripts."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import Any

import pytest
import rostopic

import fibws
from fibws.hub.server import HubServer


@pytest.fixture(autouse=True)
async def node(hub: HubServer, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[fibws.Node]:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    async with fibws.Node("talker", hub=hub.url) as node:
        await node.advertise("header", "std_msgs/Header")
        await node.advertise("header/stamp", "std_msgs/String")
        node.subscribe("words", "std_msgs/String")
        await node.graph.nodes()
        yield node


async def ask(function: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
    return await asyncio.to_thread(function, *arguments, **named)


async def test_topic_is_found_by_name() -> None:
    assert await ask(rostopic.get_topic_type, "/header") == ("std_msgs/Header", "/header", None)
    class_, name, evaluate = await ask(rostopic.get_topic_class, "header")
    assert (class_._type, name, evaluate) == ("std_msgs/Header", "/header", None)


async def test_field_is_found_in_its_topic() -> None:
    class_, name, evaluate = await ask(rostopic.get_topic_class, "/header/stamp/secs")
    assert (class_._type, name) == ("std_msgs/Header", "/header")
    assert evaluate(class_()) == 0
    type_, name, evaluate = await ask(rostopic.get_topic_type, "/header/stamp/data")
    assert (type_, name) == ("std_msgs/String", "/header/stamp")


@pytest.mark.parametrize("name", ["/nothing", "/header/colour", "/head"])
async def test_unknown_topic_gives_none(name: str) -> None:
    assert await ask(rostopic.get_topic_type, name) == (None, None, None)
    assert await ask(rostopic.get_topic_class, name) == (None, None, None)


async def test_blocking_call_waits_for_the_topic(
    node: fibws.Node, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    loop, looked = asyncio.get_running_loop(), asyncio.Event()
    monkeypatch.setattr("rostopic.sleep", lambda seconds: loop.call_soon_threadsafe(looked.set))
    waiting = asyncio.create_task(ask(rostopic.get_topic_type, "/later", blocking=True))
    await looked.wait()
    await node.advertise("later", "std_msgs/Int32")
    assert (await waiting)[0] == "std_msgs/Int32"
    assert "topic [/later] does not appear to be published yet" in capsys.readouterr().err


async def test_undefined_type_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("genpy.message.get_message_class", lambda type_: None)
    with pytest.raises(rostopic.ROSTopicException, match=r"Cannot load message class for \[std"):
        await ask(rostopic.get_topic_class, "/header")


async def test_topics_are_listed() -> None:
    published, heard = await ask(rostopic.get_topic_list)
    assert ("/header", "std_msgs/Header", ["/talker"]) in published
    assert ("/words", "std_msgs/String", ["/talker"]) in heard
    assert await ask(rostopic.find_by_type, "std_msgs/Header") == ["/header"]


async def test_missing_hub_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    with pytest.raises(rostopic.ROSTopicIOException, match=r"master! .*127\.0\.0\.1:1"):
        await ask(rostopic.get_topic_list)


async def test_topic_is_described() -> None:
    text = await ask(rostopic.get_info_text, "/header")
    assert text.startswith("Type: std_msgs/Header\n\nPublishers: \n * /talker (http://127.0.0.1:")
    assert text.endswith("/)\n\nSubscribers: None\n\n")
    with pytest.raises(rostopic.ROSTopicException, match="Unknown topic /nothing"):
        await ask(rostopic.get_info_text, "/nothing")
