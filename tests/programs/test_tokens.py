"""Programs at a hub that wants a token, as users start them."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from running_programs import Start

import fibws
from fibws.access.rights import RIGHTS, Rights
from fibws.access.token_file import TokenFile
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32, String

SCRIPT = """
import rospy
from std_msgs.msg import String

rospy.init_node("talker")
publisher = rospy.Publisher("chatter", String, latch=True, queue_size=1)
publisher.publish(rospy.get_param("/rosdistro"))
rospy.spin()
"""
LAUNCH = """
<launch>
  <param name="/size" value="3"/>
  <node name="numbers" pkg="fibws" type="broadcaster"/>
</launch>
"""


@dataclass
class TokenHub:
    """A hub with tokens: ``robot`` may do everything except what needs admin."""

    url: str
    robot: str
    folder: Path

    def node(self) -> fibws.Node:
        return fibws.Node("listener", hub=self.url, token=self.robot)

    def file(self, name: str, text: str) -> str:
        path = self.folder / name
        path.write_text(text)
        return str(path)


@pytest.fixture
async def token_hub(tmp_path: Path) -> AsyncIterator[TokenHub]:
    file = TokenFile(tmp_path / "tokens.toml")
    everything = {right: ("/**",) for right in RIGHTS}
    robot = file.add("robot", Rights(everything, {"param_write": ("/ros*",)}))
    settings = Settings(port=0, close_timeout=0.1, tokens=tmp_path / "tokens.toml")
    async with HubServer(settings) as hub:
        yield TokenHub(hub.url, robot, tmp_path)


async def test_rospy_script_works_unchanged(start: Start, token_hub: TokenHub) -> None:
    script = token_hub.file("talker.py", SCRIPT)
    await start("fibws.rospy", script, FIBWS_HUB=token_hub.url, FIBWS_TOKEN=token_hub.robot)
    async with token_hub.node() as node:
        heard = await node.wait_for_message("chatter", String, timeout=60)
    assert heard.data.strip() == "noetic"


async def test_rospy_script_without_a_token_ends_with_the_reason(
    start: Start, token_hub: TokenHub
) -> None:
    script = token_hub.file("talker.py", SCRIPT)
    program = await start("fibws.rospy", script, FIBWS_HUB=token_hub.url)
    code, _, err = await program.end()
    assert code == 1
    assert "ROSInitException" in err and "missing token" in err and "FIBWS_TOKEN" in err


async def test_topic_that_may_not_be_read_is_not_waited_for(
    start: Start, token_hub: TokenHub
) -> None:
    file = token_hub.folder / "more.toml"
    token = TokenFile(file).add("blind", Rights({"publish": ("/chatter",)}))
    async with HubServer(Settings(port=0, tokens=file)) as hub:
        words = ("topic", "echo", "/secret", "--hub", hub.url)
        program = await start("fibws", *words, FIBWS_TOKEN=token)
        code, _, err = await program.end()
    assert code != 0 and "missing right subscribe for /secret" in err


async def test_program_takes_a_token_file(start: Start, token_hub: TokenHub) -> None:
    file = token_hub.file("token", token_hub.robot)
    await start("fibws.broadcaster", "--hub", token_hub.url, "--token-file", file)
    async with token_hub.node() as node:
        await node.wait_for_message("fibonacci", Int32, timeout=60)


async def test_program_without_a_token_exits_with_77(start: Start, token_hub: TokenHub) -> None:
    program = await start("fibws.listener", "--hub", token_hub.url)
    code, _, err = await program.end()
    assert code == 77 and "missing token" in err and "Traceback" not in err


@pytest.mark.parametrize("source", ["variable", "file", "url"])
@pytest.mark.long
async def test_launched_nodes_get_the_token(start: Start, token_hub: TokenHub, source: str) -> None:
    file = token_hub.file("numbers.launch", LAUNCH)
    words, variables = ["launch", file], {"FIBWS_HUB": token_hub.url}
    if source == "variable":
        variables["FIBWS_TOKEN"] = token_hub.robot
    elif source == "file":
        words += ["--token-file", token_hub.file("token", token_hub.robot)]
    else:
        variables["FIBWS_HUB"] += f"/?token={token_hub.robot}"
    program = await start("fibws", *words, ROS_HOME=str(token_hub.folder), **variables)
    async with token_hub.node() as node:
        await node.wait_for_message("fibonacci", Int32, timeout=60)
        assert await node.params.get("/size", int) == 3
    await program.stop()


async def test_launch_without_a_token_ends_with_the_reason(
    start: Start, token_hub: TokenHub
) -> None:
    file = token_hub.file("numbers.launch", LAUNCH)
    program = await start("fibws", "launch", file, FIBWS_HUB=token_hub.url)
    code, _, err = await program.end()
    assert code == 77 and "missing token" in err
