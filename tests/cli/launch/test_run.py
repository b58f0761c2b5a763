"""``fibws launch``: running nodes at a hub."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from hub_in_thread import HubThread
from running_programs import Program, Start

from fibws.client.hub_client import HubClient
from fibws.errors import NoHub

from ..terminal import Terminal
from .conftest import Launch, write

Begin: TypeAlias = Callable[..., Any]


class Seen:
    """A launch and the lines of its standard output."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.lines: list[str] = []

    async def shows(self, text: str) -> str:
        """Read until a line contains a text; return that line."""
        while True:
            line = await self.program.line()
            assert line, f"no {text!r} in {self.lines}"
            self.lines.append(line.rstrip("\n"))
            if text in line:
                return line.rstrip("\n")

    async def end(self) -> tuple[int, str]:
        """Wait for the end; return the exit code and standard error."""
        code, out, err = await self.program.end()
        self.lines += out.splitlines()
        return code, err


@pytest.fixture
def begin(robot: Path, start: Start) -> Begin:
    """Start ``fibws launch``; without ``hub``, it starts its own."""

    async def begin(*words: str, hub: HubThread | None = None) -> Seen:
        at = ["--hub", hub.url] if hub else ["-p", "0"]
        return Seen(await start("fibws", "launch", *at, *words))

    return begin


async def test_launch_starts_a_hub_and_two_nodes(begin: Begin, robot: Path) -> None:
    file = write(
        robot,
        '<group ns="g"><remap from="fibonacci" to="/numbers"/>'
        '<node pkg="robot" type="talker" name="talker" output="screen"/>'
        '<node pkg="robot" type="listener" name="listener" output="screen"/></group>'
        '<param name="speed" value="2.5"/><param name="many" type="yaml" value="{a: [1]}"/>',
    )
    seen = await begin(file)
    hub = (await seen.shows("FIBWS_HUB=")).partition("=")[2]
    await seen.shows("[g/listener-2] [INFO] [")
    with HubClient("test", hub) as client:
        nodes = client.call("/rosapi/nodes")["nodes"]
        assert {"/g/talker", "/g/listener"} <= set(nodes)
        assert "/numbers" in client.call("/rosapi/topics")["topics"]
        assert client.call("/rosapi/get_param", {"name": "/speed"})["value"] == "2.5"
        assert client.call("/rosapi/get_param", {"name": "/many"})["value"] == '{"a":[1]}'
    seen.program.send(signal.SIGINT)
    assert await seen.end() == (0, "")
    killed = [line for line in seen.lines if "killing" in line]
    assert killed == [
        "[g/listener-2] killing on exit",
        "[g/talker-1] killing on exit",
        "[hub] killing on exit",
    ]
    assert seen.lines[-1] == "done"
    assert "auto-starting new hub" in seen.lines
    assert " * /speed: 2.5" in seen.lines
    assert "    talker (robot/talker)" in seen.lines


async def test_running_hub_is_used_and_not_stopped(
    begin: Begin, robot: Path, hub: HubThread
) -> None:
    with HubClient("test", hub.url) as client:
        for name in ("/old/a", "/kept"):
            client.call("/rosapi/set_param", {"name": name, "value": "1"})
        client.call("/rosapi/set_param", {"name": "/n/gone", "value": "[1, 2]"})
        dumped = robot / "dumped.yaml"
        file = write(
            robot,
            f'<rosparam command="dump" file="{dumped}" param="n"/>'
            '<rosparam command="delete" param="n"/><rosparam command="delete" param="never"/>'
            '<group ns="old" clear_params="true"><param name="b" value="2"/>'
            '<group ns="in" clear_params="true"/></group>'
            f'<param name="bytes" binfile="{robot / "package.xml"}"/>'
            '<node pkg="robot" type="waiter" name="w" output="screen"/>',
        )
        seen = await begin(file, "--no-summary", "-v", hub=hub)
        await seen.shows("[w-1] waits __name:=w None")
        names = client.call("/rosapi/get_param_names")["names"]
        assert {"/old/b", "/kept", "/bytes"} <= set(names)
        assert not {"/old/a", "/n/gone"} & set(names)
        assert dumped.read_text() == "gone:\n- 1\n- 2\n"
        seen.program.send(signal.SIGTERM)
        code, err = await seen.end()
        assert code == 0
        assert "/bytes: " in err and "base64" in err
        assert "rosparam delete /never: " in err
        assert client.call("/rosapi/get_time")
    assert f"... loading XML file [{file}]" in seen.lines
    assert "Added parameter [/old/b]" in seen.lines
    assert "SUMMARY" not in seen.lines
    assert not any("[hub]" in line for line in seen.lines)


async def test_launch_ends_with_its_nodes_and_reports_failures(
    begin: Begin, robot: Path, hub: HubThread
) -> None:
    file = write(
        robot,
        '<node pkg="robot" type="failer" name="f"/><node pkg="robot" type="nope" name="n"/>'
        '<node pkg="rosbridge_server" type="rosbridge_websocket" name="bridge"/>',
    )
    seen = await begin(file, hub=hub)
    code, err = await seen.end()
    assert code == 1
    assert "[f-1] does not work\n" in err
    assert re.search(r"\[f-1\] process has died \[pid \d+, exit code 1, cmd .*failer", err)
    assert "ERROR: cannot launch node of type [robot/nope]: " in err
    assert any(line.startswith("[bridge] not started") for line in seen.lines)
    assert "[f-1] works" not in seen.lines
    [folder] = [line.split()[-1] for line in seen.lines if line.startswith("... logging to ")]
    assert sorted((Path(folder) / "f-1.log").read_text().splitlines()) == ["does not work", "works"]
    assert f"log file: {folder}/f-1.log" in err


@pytest.mark.parametrize("option", ["--screen", "--log"])
async def test_screen_and_log_options_apply_to_all_nodes(
    option: str, begin: Begin, robot: Path, hub: HubThread
) -> None:
    file = write(
        robot,
        '<node pkg="robot" type="failer" name="a"/>'
        '<node pkg="robot" type="failer" name="b" output="screen"/>',
    )
    seen = await begin(file, option, hub=hub)
    await seen.end()
    shown = [line for line in seen.lines if "works" in line]
    assert sorted(shown) == (["[a-1] works", "[b-2] works"] if option == "--screen" else [])


async def test_required_option_applies_to_all_nodes(
    begin: Begin, robot: Path, hub: HubThread
) -> None:
    file = write(
        robot,
        '<node pkg="robot" type="waiter" name="w"/>'
        '<node pkg="robot" type="failer" name="f" respawn="true"/>',
    )
    seen = await begin(file, "--required", hub=hub)
    code, err = await seen.end()
    assert code == 1
    assert "REQUIRED process [f-2] has died!" in err
    assert "[w-1] killing on exit" in seen.lines


async def test_commands_of_ros_are_nodes(begin: Begin, robot: Path, hub: HubThread) -> None:
    file = write(
        robot,
        '<group ns="g"><remap from="here" to="/there"/><node pkg="rostopic" type="rostopic" '
        'name="beeper" args="pub -r 50 here std_msgs/Int32 5"/></group>'
        '<node pkg="rosparam" type="rosparam" name="setter" args="set /speed 7"/>'
        '<node pkg="rosservice" type="rosservice" name="caller" output="screen" '
        'args="type /rosapi/topics"/>',
    )
    seen = await begin(file, hub=hub)
    ends = {"[caller-3] rosapi/Topics", "[setter-2] process has finished cleanly"}
    while not ends <= set(seen.lines):
        await seen.shows("[")
    with HubClient("test", hub.url) as client:
        assert client.call("/rosapi/get_param", {"name": "/speed"})["value"] == "7"
        client.subscribe("/there")
        assert next(client.messages("/there")) == {"data": 5}
        assert "/g/beeper" in client.call("/rosapi/nodes")["nodes"]
    seen.program.send(signal.SIGINT)
    assert await seen.end() == (0, "")


async def test_launch_without_nodes_sets_parameters(
    begin: Begin, robot: Path, hub: HubThread
) -> None:
    with HubClient("test", hub.url) as client:
        client.call("/rosapi/delete_param", {"name": "/rosdistro"})
        text = '<param name="a" value="1"/><param name="rosversion" value="5.0"/>'
        seen = await begin(write(robot, text), hub=hub)
        assert await seen.end() == (0, "")
        assert "No processes to monitor" in seen.lines
        expected = {"/a": "1", "/rosdistro": '"noetic\\n"', "/rosversion": "5.0"}
        for name, value in expected.items():
            assert client.call("/rosapi/get_param", {"name": name})["value"] == value
    assert [line for line in seen.lines if line.startswith(" * ")] == [
        " * /a: 1",
        " * /rosdistro: noetic",
        " * /rosversion: 5.0",
    ]


async def test_waiting_for_a_hub_can_be_interrupted(begin: Begin, robot: Path) -> None:
    hub = HubThread()
    hub.start()
    hub.stop()
    seen = await begin(write(robot, ""), "--wait", hub=hub)
    await seen.shows("no hub is running yet, will wait for it to start")
    seen.program.send(signal.SIGINT)
    assert await seen.end() == (0, "")
    assert "auto-starting new hub" not in seen.lines


async def test_wait_option_uses_a_running_hub(begin: Begin, robot: Path, hub: HubThread) -> None:
    seen = await begin(write(robot, ""), "--wait", hub=hub)
    assert await seen.end() == (0, "")
    assert f"FIBWS_HUB={hub.url}" in seen.lines


async def test_hub_on_another_machine_is_not_started(start: Start, robot: Path) -> None:
    program = await start("fibws", "launch", write(robot, ""), "--hub", "ws://127.0.0.2:1")
    code, _, err = await program.end()
    assert code == 1
    assert "ws://127.0.0.2:1" in err


async def test_hub_with_tls_is_not_started(start: Start, robot: Path) -> None:
    program = await start("fibws", "launch", write(robot, ""), "--hub", "wss://127.0.0.1:1")
    code, _, err = await program.end()
    assert code == 1
    assert "wss://127.0.0.1:1" in err


async def test_hub_that_cannot_start_is_an_error_of_one_line(start: Start, robot: Path) -> None:
    program = await start(
        "fibws", "launch", write(robot, ""), "--no-summary", "-p", "0", FIBWS_MAX_CALLS="x"
    )
    code, _, err = await program.end()
    assert code == 1
    assert "FIBWS_MAX_CALLS" in err
    assert err.count("\n") == 1


@pytest.mark.long
async def test_launch_ends_when_its_output_is_closed(begin: Begin, robot: Path) -> None:
    file = write(robot, '<node pkg="robot" type="talker" name="talker" output="screen"/>')
    seen = await begin(file)
    await seen.shows("[talker-1]")
    seen.program.stop_reading()
    assert await seen.end() == (0, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_full_disk_is_an_error(robot: Path, hub: HubThread) -> None:
    file = write(robot, '<node pkg="robot" type="talker" name="talker" output="screen"/>')
    words = (sys.executable, "-m", "fibws", "launch", file, "--no-summary", "--hub", hub.url)
    with open("/dev/full", "wb") as full:
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (1, "Error: No space left on device\n")


def test_ctrl_c_while_parameters_are_set(
    robot: Path, hub: HubThread, launch: Launch, monkeypatch: pytest.MonkeyPatch
) -> None:
    def prepared(*_: object) -> Iterator[None]:
        os.kill(os.getpid(), signal.SIGINT)
        while True:
            yield

    monkeypatch.setattr("fibws.ros1.launch.session.prepare", prepared)
    file = write(robot, '<node pkg="robot" type="waiter" name="w"/>')
    result = launch(file, "--hub", hub.url)
    assert result.exit_code == 0, result.output
    assert "process[" not in result.output


async def test_ctrl_c_while_the_hub_does_not_respond(start: Start, robot: Path) -> None:
    file = write(robot, '<node pkg="robot" type="waiter" name="w"/>')
    with socket.create_server(("127.0.0.1", 0)) as server:
        url = f"ws://127.0.0.1:{server.getsockname()[1]}"
        program = await start("fibws", "launch", file, "--no-summary", "--hub", url)
        connection, _ = await asyncio.to_thread(server.accept)
        with connection:
            program.send(signal.SIGINT)
            assert await program.end() == (0, "done\n", "")


async def test_pid_file(begin: Begin, robot: Path, tmp_path: Path) -> None:
    file = write(robot, '<node pkg="robot" type="waiter" name="w" output="screen"/>')
    seen = await begin(file, "--pid", str(tmp_path / "pid"))
    await seen.shows("waits")
    assert int((tmp_path / "pid").read_text()) == seen.program.pid
    seen.program.send(signal.SIGINT)
    await seen.end()
    assert not (tmp_path / "pid").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such terminals")
def test_closed_terminal_ends_everything(robot: Path) -> None:
    file = write(robot, '<node pkg="robot" type="talker" name="talker" output="screen"/>')
    words = (sys.executable, "-m", "fibws", "launch", file, "-p", "0")
    environment = {name: os.environ[name] for name in ("ROS_PACKAGE_PATH", "ROS_HOME")}
    terminal = Terminal(*words, **environment)
    try:
        terminal.wait_for("[INFO]")
        found = re.search(r"FIBWS_HUB=(ws:[\d.:/]+)", terminal.output)
        assert found is not None
        terminal.hang_up()
        terminal.process.wait(60)
        with pytest.raises(NoHub):
            HubClient("test", found[1])
    finally:
        terminal.process.kill()
        terminal.process.wait()
