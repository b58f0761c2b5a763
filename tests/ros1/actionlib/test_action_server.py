"""A server that decides on each goal by its handle."""

from __future__ import annotations

import signal
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest

import fibws
from fibws.hub.server import HubServer
from ros1.side_by_side import Part, our_ros

from .conftest import StartScript


async def test_client_follows_its_goal() -> None:
    async with our_ros() as ros:
        server, client = await ros.play(
            Part("actions/handles_server.py", until="ready"),
            Part("actions/handles_client.py", interrupted=False),
        )
    assert server.code == client.code == 0, client.err
    assert [line for line in client.out if "done" in line] == [
        *("goal 1 done: True", "goal 2 done: True", "goal 3 done: True"),
        *("waiting done: True", "begun done: True"),
    ]
    assert [line for line in client.out if line.isupper() and " " not in line] == [
        *("SUCCEEDED", "REJECTED", "ABORTED", "RECALLED", "PREEMPTED"),
    ]
    assert "PENDING ACTIVE" in client.out
    assert client.out[-1] == "['PREEMPTED', 'PREEMPTED']"
    assert [line.rpartition(" ")[2] for line in server.err] == ["5", "0", "0", "1", "4"]


SERVER = """
import rospy, actionlib
from actionlib.msg import TwoIntsAction

def goal(handle):
    print("goal", handle.get_goal().a, handle.get_goal_id().id.rpartition("-")[0], flush=True)
    handle.set_accepted()
    if handle.get_goal().a:
        handle.set_succeeded(text="at once")

rospy.init_node("server")
server = actionlib.ActionServer("two", TwoIntsAction, goal, auto_start=False)
server.register_cancel_callback(lambda handle: print("cancel", handle.get_goal().a, flush=True))
server.start()
print("ready", flush=True)
rospy.wait_for_message("stop", rospy.AnyMsg)
server.stop()
print("stopped", flush=True)
rospy.spin()
"""


class Client:
    """Says to the server whatever a test wants."""

    def __init__(self, node: fibws.Node) -> None:
        self.node = node

    async def start(self) -> None:
        self.results = self.node.subscribe("two/result", "actionlib/TwoIntsActionResult")
        self.statuses = self.node.subscribe("two/status", "actionlib_msgs/GoalStatusArray")
        self.goals = await self.node.advertise(
            "two/goal", "actionlib/TwoIntsActionGoal", peers=True
        )
        self.cancels = await self.node.advertise("two/cancel", "actionlib_msgs/GoalID")

    async def send(self, name: str, a: int, secs: int = 0) -> None:
        goal_id = {"id": name, "stamp": {"secs": secs, "nsecs": 0}}
        await self.goals.publish(goal_id=goal_id, goal={"a": a})

    async def cancel(self, name: str, secs: int = 0) -> None:
        await self.cancels.publish(id=name, stamp={"secs": secs, "nsecs": 0})

    async def result(self) -> tuple[str, int, str]:
        status: Any = (await anext(self.results)).status
        return status.goal_id.id, status.status, status.text

    async def listed(self, *names: str) -> None:
        """Wait until the status lists exactly these goals."""
        async for message in self.statuses:
            if [status.goal_id.id for status in message.status_list] == list(names):
                return


@pytest.fixture
async def client(hub: HubServer) -> AsyncIterator[Client]:
    async with fibws.Node("client", hub=hub.url) as node:
        client = Client(node)
        await client.start()
        yield client


async def test_missing_id_and_time_are_generated(
    client: Client, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    server = await start_script(script(SERVER))
    assert await server.line() == "ready\n"
    await client.send("", 1)
    assert await server.line() == "goal 1 /server-1\n"
    name, status, text = await client.result()
    assert name.startswith("/server-1-")
    assert (status, text) == (3, "at once")


async def test_repeated_goal_is_ignored(
    client: Client, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    server = await start_script(script(SERVER))
    assert await server.line() == "ready\n"
    for name in ("a-1", "a-1", "b-1"):
        await client.send(name, 1)
    assert [await server.line(), await server.line()] == ["goal 1 a\n", "goal 1 b\n"]
    assert [(await client.result())[0], (await client.result())[0]] == ["a-1", "b-1"]


async def test_goal_can_be_canceled_before_it_arrives(
    client: Client, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    server = await start_script(script(SERVER))
    assert await server.line() == "ready\n"
    await client.cancel("a-1")
    await client.listed("a-1")
    await client.send("a-1", 1)
    assert await client.result() == ("a-1", 8, "")
    await client.cancel("z-1", secs=100)
    await client.listed("a-1", "z-1")
    await client.send("b-1", 1, secs=99)
    await client.send("c-1", 1, secs=101)
    name, status, text = await client.result()
    assert (name, status) == ("b-1", 8)
    assert "its timestamp is before the timestamp of the last cancel request" in text
    assert await server.line() == "goal 1 c\n"


async def test_cancel_callback_is_called_once_for_each_goal(
    client: Client, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    server = await start_script(script(SERVER))
    assert await server.line() == "ready\n"
    await client.send("a-1", 0)
    assert await server.line() == "goal 0 a\n"
    for name in ("a-1", "a-1", "z-1"):
        await client.cancel(name)
    await client.listed("a-1", "z-1")
    await client.send("b-1", 1)
    assert [await server.line(), await server.line()] == ["cancel 0\n", "goal 1 b\n"]


async def test_parameters_set_status_rate_and_timeout(
    client: Client, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    await client.node.params.set("/actionlib_status_frequency", 50.0)
    await client.node.params.set("/two/status_list_timeout", 0.01)
    server = await start_script(script(SERVER))
    assert await server.line() == "ready\n"
    await client.send("a-1", 1)
    await client.listed("a-1")
    await client.listed()


async def test_stopped_server_ignores_goals(
    client: Client, start_script: StartScript, script: Callable[[str], Path]
) -> None:
    server = await start_script(script(SERVER))
    assert await server.line() == "ready\n"
    stop = await client.node.advertise("stop", "std_msgs/Empty", latch=True)
    await stop.publish()
    assert await server.line() == "stopped\n"
    async for peers in client.goals.peers.changes():
        if not peers:
            break
    await client.send("a-1", 1)
    server.send(signal.SIGINT)
    assert await server.end() == (0, "", "")
