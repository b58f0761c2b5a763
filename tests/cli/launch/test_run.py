"""``fibws launch``: real launches, with two scripts at a hub."""

from __future__ import annotations

import os
import re
import signal
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
    """What a launch shows on standard output."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.lines: list[str] = []

    async def shows(self, text: str) -> str:
        """Read until a line has this in it; return that line."""
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
    """Start ``fibws launch``; it starts a hub of its own if none is named."""

    async def begin(*words: str, hub: HubThread | None = None) -> Seen:
        at = ["--hub", hub.url] if hub else ["-p", "0"]
        return Seen(await start("fibws", "launch", *at, *words))

    return begin


async def test_two_nodes_talk_at_a_hub_that_is_started(begin: Begin, robot: Path) -> None:
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


async def test_a_hub_that_is_there_is_used_and_left(
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
        assert "/bytes: parameters hold no bytes here, so this is their base64" in err
        assert "rosparam delete /never: it is not set" in err
        assert client.call("/rosapi/get_time")
    assert f"... loading XML file [{file}]" in seen.lines
    assert "Added parameter [/old/b]" in seen.lines
    assert "SUMMARY" not in seen.lines
    assert not any("[hub]" in line for line in seen.lines)


async def test_when_all_nodes_have_ended_it_ends_with_what_became_of_them(
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
    assert "[bridge] the hub is rosbridge_server already: nothing to do" in seen.lines
    assert "[f-1] works" not in seen.lines
    [folder] = [line.split()[-1] for line in seen.lines if line.startswith("... logging to ")]
    assert sorted((Path(folder) / "f-1.log").read_text().splitlines()) == ["does not work", "works"]
    assert f"log file: {folder}/f-1.log" in err


@pytest.mark.parametrize("option", ["--screen", "--log"])
async def test_where_the_output_goes_can_be_said_for_all(
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


async def test_all_nodes_can_be_required(begin: Begin, robot: Path, hub: HubThread) -> None:
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


async def test_without_nodes_the_parameters_are_set_and_that_is_all(
    begin: Begin, robot: Path, hub: HubThread
) -> None:
    seen = await begin(write(robot, '<param name="a" value="1"/>'), hub=hub)
    assert await seen.end() == (0, "")
    assert "No processes to monitor" in seen.lines
    with HubClient("test", hub.url) as client:
        assert client.call("/rosapi/get_param", {"name": "/a"})["value"] == "1"


async def test_a_launch_file_of_rosbridge_needs_nothing(
    begin: Begin, robot: Path, hub: HubThread
) -> None:
    file = write(
        robot,
        '<include file="$(find rosbridge_server)/launch/rosbridge_websocket.launch">'
        '<arg name="port" value="9090"/></include>',
    )
    code, err = await (await begin(file, hub=hub)).end()
    assert code == 0
    assert err == "WARNING: rosbridge_server: nothing is started for it: the hub is one\n"


async def test_a_hub_can_be_waited_for(begin: Begin, robot: Path) -> None:
    hub = HubThread()
    hub.start()
    hub.stop()
    seen = await begin(write(robot, ""), "--wait", hub=hub)
    await seen.shows("no hub is running yet, will wait for it to start")
    seen.program.send(signal.SIGINT)
    assert await seen.end() == (0, "")
    assert "auto-starting new hub" not in seen.lines


async def test_a_hub_that_was_waited_for_is_used(begin: Begin, robot: Path, hub: HubThread) -> None:
    seen = await begin(write(robot, ""), "--wait", hub=hub)
    assert await seen.end() == (0, "")
    assert f"FIBWS_HUB={hub.url}" in seen.lines


async def test_a_hub_elsewhere_is_not_started(start: Start, robot: Path) -> None:
    program = await start("fibws", "launch", write(robot, ""), "--hub", "ws://127.0.0.2:1")
    code, _, err = await program.end()
    assert (code, err) == (1, "Error: No hub at ws://127.0.0.2:1. Start one with: fibws hub\n")


async def test_a_hub_that_speaks_tls_is_not_started(start: Start, robot: Path) -> None:
    program = await start("fibws", "launch", write(robot, ""), "--hub", "wss://127.0.0.1:1")
    code, _, err = await program.end()
    assert (code, err) == (1, "Error: No hub at wss://127.0.0.1:1. Start one with: fibws hub\n")


async def test_a_hub_that_cannot_start_is_said_in_a_line(start: Start, robot: Path) -> None:
    program = await start(
        "fibws", "launch", write(robot, ""), "--no-summary", "-p", "0", FIBWS_MAX_CALLS="x"
    )
    code, _, err = await program.end()
    assert code == 1
    assert "--max-calls" in err
    assert err.count("\n") == 1


async def test_it_ends_when_nobody_reads_what_it_shows(begin: Begin, robot: Path) -> None:
    file = write(robot, '<node pkg="robot" type="talker" name="talker" output="screen"/>')
    seen = await begin(file)
    await seen.shows("[talker-1]")
    seen.program.stop_reading()
    assert await seen.end() == (0, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no such device")
def test_a_disk_that_is_full_is_told_of(robot: Path, hub: HubThread) -> None:
    file = write(robot, '<node pkg="robot" type="talker" name="talker" output="screen"/>')
    words = (sys.executable, "-m", "fibws", "launch", file, "--no-summary", "--hub", hub.url)
    with open("/dev/full", "wb") as full:
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (1, "Error: No space left on device\n")


def test_ctrl_c_is_heard_between_two_parameters(
    robot: Path, hub: HubThread, launch: Launch, monkeypatch: pytest.MonkeyPatch
) -> None:
    def prepared(*_: object) -> Iterator[None]:
        os.kill(os.getpid(), signal.SIGINT)
        while True:
            yield

    monkeypatch.setattr("fibws.cli.launch.run.prepare", prepared)
    file = write(robot, '<node pkg="robot" type="waiter" name="w"/>')
    result = launch(file, "--hub", hub.url)
    assert result.exit_code == 0, result.output
    assert "process[" not in result.output


async def test_its_id_is_kept_in_a_file(begin: Begin, robot: Path, tmp_path: Path) -> None:
    file = write(robot, '<node pkg="robot" type="waiter" name="w" output="screen"/>')
    seen = await begin(file, "--pid", str(tmp_path / "pid"))
    await seen.shows("waits")
    assert int((tmp_path / "pid").read_text()) == seen.program.pid
    seen.program.send(signal.SIGINT)
    await seen.end()
    assert not (tmp_path / "pid").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such terminal")
def test_on_a_terminal_names_have_colours(robot: Path, hub: HubThread) -> None:
    file = write(robot, '<node pkg="robot" type="waiter" name="w" output="screen"/>')
    words = (sys.executable, "-m", "fibws", "launch", file, "--hub", hub.url)
    environment = {name: os.environ[name] for name in ("ROS_PACKAGE_PATH", "ROS_HOME")}
    terminal = Terminal(*words, TERM="xterm", NO_COLOR="", **environment)
    try:
        terminal.wait_for("\x1b[36m[w-1]\x1b[0m waits")
        terminal.process.send_signal(signal.SIGINT)
        terminal.wait_for("[w-1] killing on exit")
        terminal.wait_for("done")
        assert terminal.ended() == 0
    finally:
        terminal.close()


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such terminal")
def test_when_the_terminal_is_gone_nothing_is_left_over(robot: Path) -> None:
    file = write(robot, '<node pkg="robot" type="talker" name="talker" output="screen"/>')
    words = (sys.executable, "-m", "fibws", "launch", file, "-p", "0")
    environment = {name: os.environ[name] for name in ("ROS_PACKAGE_PATH", "ROS_HOME")}
    terminal = Terminal(*words, **environment)
    try:
        terminal.wait_for("[talker-1]")
        found = re.search(r"FIBWS_HUB=(ws:[\d.:/]+)", terminal.told)
        assert found is not None
        terminal.hang_up()
        terminal.process.wait(60)
        with pytest.raises(NoHub):
            HubClient("test", found[1])
    finally:
        terminal.process.kill()
        terminal.process.wait()
