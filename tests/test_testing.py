"""fibws.testing: tests of one's own nodes."""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import fibws
from fibws.errors import HubError
from fibws.hub import Settings
from fibws.msg.std_msgs import Int32, String
from fibws.testing import (
    HubThread,
    receive,
    running,
    wait_for_node,
    wait_for_publishers,
    wait_for_subscribers,
    wait_until,
)


@pytest.fixture
def hub() -> Iterator[HubThread]:
    with HubThread() as hub:
        yield hub


def run_pytest(folder: Path) -> str:
    """Run the tests in a folder as their author would; return the output if they pass."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error"]
    environment = {name: value for name, value in os.environ.items() if "PYTEST" not in name}
    ran = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def test_plugin_gives_each_test_a_hub_and_a_node(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["fibws.testing"]\n')
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\nasyncio_default_fixture_loop_scope = function\n"
    )
    (tmp_path / "test_nodes.py").write_text(
        """
import asyncio
import logging
import os
import subprocess
import sys

import pytest

import fibws
from fibws.hub import Settings
from fibws.testing import wait_for_node


def test_without_asyncio(hub):
    assert os.environ["FIBWS_HUB"] == hub.url


@pytest.mark.asyncio
async def test_nodes_meet(hub, node):
    async with fibws.Node("other") as other:
        assert await node.graph.nodes() == await other.graph.nodes()
        assert "/test" in await node.graph.nodes()


@pytest.mark.asyncio
async def test_graph_is_new_in_each_test(node):
    assert "/other" not in await node.graph.nodes()


@pytest.mark.asyncio
async def test_program_of_its_own(node):
    with subprocess.Popen([sys.executable, "-m", "fibws.listener", "--node-name", "ear"]) as ear:
        await wait_for_node(node, "ear")
        ear.terminate()


class TestSmallHub:
    @pytest.fixture
    def hub_settings(self):
        return Settings(port=0, max_connections=1)

    @pytest.mark.asyncio
    async def test_settings_can_be_chosen(self, hub, node):
        other = fibws.Node("other", rosout=False)
        refused = asyncio.Event()
        handler = logging.Handler()
        handler.emit = lambda record: refused.set()
        other.log.addHandler(handler)
        opening = asyncio.create_task(other.__aenter__())
        await refused.wait()
        assert not opening.done()
        opening.cancel()
        await asyncio.wait([opening])
"""
    )
    assert "5 passed" in run_pytest(tmp_path)


def test_hub_keeps_its_port_when_it_starts_again() -> None:
    hub = HubThread()
    hub.start()
    with pytest.raises(RuntimeError, match="running already"):
        hub.start()
    url, port = hub.url, hub.port
    hub.stop()
    hub.stop()
    hub.start()
    assert (hub.url, hub.port) == (url, port)
    hub.stop()


def test_hub_that_cannot_listen_raises(hub: HubThread) -> None:
    other = HubThread(Settings(port=hub.port))
    with pytest.raises(HubError, match=str(hub.port)):
        other.start()
    other.stop()


async def test_node_reconnects_to_a_hub_that_starts_again(hub: HubThread) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        hub.stop()
        hub.start()
        await node.flush()
        assert "/node" in await node.graph.nodes()


async def test_receive_returns_messages_or_says_how_many_came(hub: HubThread) -> None:
    async with fibws.Node("node", hub=hub.url) as node:
        numbers = node.subscribe("numbers", Int32)
        publisher = await node.advertise("numbers", Int32)
        for number in range(3):
            await publisher.publish(number)
        assert [message.data for message in await receive(numbers, 2)] == [0, 1]
        with pytest.raises(fibws.WaitTimeout, match=r"1 of 2 .*/numbers"):
            await receive(numbers, 2, timeout=0.1)


async def test_wait_until_returns_what_holds() -> None:
    values = iter([0, "", "there"])
    assert await wait_until(lambda: next(values)) == "there"

    async def later() -> int:
        await asyncio.sleep(0)
        return 8

    assert await wait_until(later) == 8
    with pytest.raises(fibws.WaitTimeout, match=r"0\.05 s.*\[\]"):
        await wait_until(lambda: [], timeout=0.05)


async def test_error_of_a_condition_is_raised() -> None:
    def broken() -> bool:
        raise TimeoutError("its own")

    with pytest.raises(TimeoutError, match="its own"):
        await wait_until(broken)


async def test_ends_of_a_topic_are_awaited(hub: HubThread) -> None:
    async with fibws.Node("a", hub=hub.url) as a, fibws.Node("b", hub=hub.url) as b:
        await wait_for_node(a, "b")
        b.subscribe("chatter", String)
        assert await wait_for_subscribers(a, "chatter") == ["/b"]
        await b.advertise("chatter", String)
        assert await wait_for_publishers(a, "chatter") == ["/b"]
        with pytest.raises(fibws.WaitTimeout, match=r"/chatter .*1 of 2"):
            await wait_for_subscribers(a, "chatter", count=2, timeout=0.05)
        with pytest.raises(fibws.WaitTimeout, match="/nobody"):
            await wait_for_node(a, "nobody", timeout=0.05)


async def test_program_runs_while_the_block_does() -> None:
    events: list[str] = []

    async def main() -> None:
        events.append("started")
        try:
            await asyncio.Event().wait()
        finally:
            events.append("ended")

    async with running(main()):
        await wait_until(lambda: events)
        assert events == ["started"]
    assert events == ["started", "ended"]


async def test_failure_of_a_program_ends_the_block() -> None:
    async def main() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        async with running(main()):
            await asyncio.Event().wait()
    task = asyncio.current_task()
    assert task is not None and not task.cancelling()


async def test_failure_of_the_block_is_raised() -> None:
    with pytest.raises(AssertionError):
        async with running(asyncio.sleep(60)):
            raise AssertionError


async def test_failure_while_a_program_is_cancelled_is_raised() -> None:
    started = asyncio.Event()

    async def main() -> None:
        try:
            started.set()
            await asyncio.Event().wait()
        finally:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        async with running(main()):
            await started.wait()


def test_example_of_the_documentation_passes(tmp_path: Path) -> None:
    page = (Path(__file__).parents[1] / "docs" / "python-nodes.md").read_text("utf-8")
    section = page[page.index("\n## Testing\n") : page.index("\n## A hub in your program\n")]
    files = re.findall(r"`([a-z_]+\.(?:py|toml))`:\n\n```\w+\n(.*?)```", section, re.DOTALL)
    for name, text in files:
        (tmp_path / name).write_text(text)
    assert len(files) == section.count("\n```python\n") + section.count("\n```toml\n") == 4
    assert "3 passed" in run_pytest(tmp_path)


async def test_mistaken_arguments_are_answered_with_what_to_give() -> None:
    mistaken: Any = "numbers"
    with pytest.raises(TypeError, match=r"coroutine such as main\(\), got 'numbers'"):
        async with running(mistaken):
            pass
    with pytest.raises(TypeError, match=r"what node\.subscribe returns, got 'numbers'"):
        await receive(mistaken, 1)
    with pytest.raises(TypeError, match="a function such as lambda: x == 5, got 'numbers'"):
        await wait_until(mistaken)
