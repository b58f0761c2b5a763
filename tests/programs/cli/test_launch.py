"""``fibws launch``: what it lists, and real launches with two scripts at a hub."""

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
from click.testing import CliRunner, Result

from fibws.cli import command
from fibws.cli.link import Link
from fibws.errors import NoHub

from ..conftest import Program, Start
from .conftest import HubThread
from .terminal import Terminal

MANIFEST = """<package format="2"><name>robot</name><version>0.0.0</version>
<description>x</description><maintainer email="a@example.com">a</maintainer>
<license>BSD</license></package>"""

WAITER = f"""#!{sys.executable}
import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
print("waits", *sys.argv[1:], os.environ.get("ROS_NAMESPACE"), flush=True)
signal.pause()
"""
FAILER = f"""#!{sys.executable}
import sys
print("works", flush=True)
sys.exit("does not work")
"""
# Started as it is: it prints what rospy would print, and needs none.
TALKER = "#!/bin/sh\nexec '{python}' -m fibws.broadcaster --rate 50 \"$@\"\n"
LISTENER = "#!/bin/sh\nexec '{python}' -m fibws.listener \"$@\"\n"

LAUNCH = """<launch>
  <arg name="speed" default="2.5" doc="how fast"/>
  <arg name="name"/>
  <param name="speed" value="$(arg speed)"/>
  <rosparam>limits: {low: 1, high: deg(180)}</rosparam>
  <group ns="g">
    <node pkg="robot" type="waiter" name="$(arg name)" args="a 'b c'" output="screen">
      <remap from="x" to="y"/><param name="p" value="1"/>
    </node>
  </group>
</launch>"""

Launch: TypeAlias = Callable[..., Result]


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a package with programs and a launch file, which the environment names."""
    root = tmp_path / "src" / "robot"
    (root / "scripts").mkdir(parents=True)
    (root / "launch").mkdir()
    (root / "package.xml").write_text(MANIFEST)
    (root / "launch" / "robot.launch").write_text(LAUNCH)
    for name, text in {
        "waiter": WAITER,
        "failer": FAILER,
        "talker": TALKER,
        "listener": LISTENER,
    }.items():
        path = root / "scripts" / name
        path.write_text(text.replace("{python}", sys.executable))
        path.chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.setenv("ROS_HOME", str(tmp_path / "home"))
    for name in ("ROS_LOG_DIR", "ROS_NAMESPACE", "FIBWS_HUB", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)
    return root


@pytest.fixture
def launch(robot: Path) -> Launch:
    """Run ``fibws launch`` with these words, where there is no hub."""

    def launch(*words: str, input: str | bytes | None = None) -> Result:
        return CliRunner().invoke(command, ["launch", *words], input=input, prog_name="fibws")

    return launch


def write(robot: Path, text: str) -> str:
    """Write a launch file; return its path."""
    file = robot / "launch" / "test.launch"
    file.write_text(f"<launch>{text}</launch>")
    return str(file)


# What is listed


def test_nodes_are_listed(launch: Launch) -> None:
    result = launch("--nodes", "robot", "robot.launch", "name:=n")
    assert (result.exit_code, result.output) == (0, "/g/n\n")


def test_parameters_are_dumped_as_yaml(launch: Launch) -> None:
    result = launch("--dump-params", "robot", "robot.launch", "name:=n", "speed:=fast")
    assert result.stdout == (
        "/g/n/p: 1\n/limits/high: 3.141592653589793\n/limits/low: 1\n/speed: fast\n\n"
    )


def test_the_arguments_of_a_file_are_listed(launch: Launch) -> None:
    assert launch("--ros-args", "robot", "robot.launch").output == (
        "Required Arguments:\n  name: undocumented\n"
        'Optional Arguments:\n  speed (default "2.5"): how fast\n'
    )


def test_files_are_listed(launch: Launch, robot: Path) -> None:
    file = write(
        robot, '<include file="$(dirname)/robot.launch"><arg name="name" value="n"/></include>'
    )
    assert launch("--files", file).output == f"{file}\n{robot / 'launch/robot.launch'}\n"


def test_the_command_of_a_node_is_told(launch: Launch, robot: Path) -> None:
    result = launch("--args", "g/n", "robot", "robot.launch", "name:=n", "-p", "1234")
    line = f"{sys.executable} -P -m fibws.rospy {robot}/scripts/waiter a 'b c' x:=y __name:=n"
    assert result.output == f"FIBWS_HUB=ws://127.0.0.1:1234 ROS_NAMESPACE=/g {line}\n"


def test_the_file_of_a_node_is_told(launch: Launch, robot: Path) -> None:
    for option in ("--find-node", "--find"):
        result = launch(option, "/g/n", "robot", "robot.launch", "name:=n")
        assert result.output == f"{robot / 'launch/robot.launch'}\n"


def test_a_node_that_is_not_there_is_an_error(launch: Launch) -> None:
    result = launch("--args", "/g/m", "robot", "robot.launch", "name:=n")
    assert result.exit_code == 1
    assert result.stderr == (
        "Error: Cannot find node /g/m; did you mean /g/n? There are:\n * /g/n\n"
    )


def test_a_launch_can_be_checked(launch: Launch, robot: Path) -> None:
    result = launch("--check", "robot", "robot.launch", "name:=n")
    assert (result.exit_code, result.output) == (0, "1 file, 1 node: nothing is wrong\n")
    file = write(
        robot,
        '<node pkg="robot" type="nope" name="n"/><node pkg="rosapi" type="rosapi_node" name="r"/>',
    )
    result = launch("--check", file)
    assert result.exit_code == 1
    assert f"{file}:1: <node n>: no executable 'nope' in package 'robot'" in result.output


def test_a_file_may_come_in_by_a_pipe(launch: Launch) -> None:
    text = '<launch><node pkg="p" type="t" name="n"/></launch>'
    assert launch("--nodes", "-", input=text).output == "/n\n"


def test_all_can_be_in_a_namespace(launch: Launch, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ("--nodes", "robot", "robot.launch", "name:=n")
    assert launch(*words, "__ns:=a").output == "/a/g/n\n"
    monkeypatch.setenv("ROS_NAMESPACE", "/b")
    assert launch(*words).output == "/b/g/n\n"


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ([], "Write PACKAGE FILE, or the path of a launch file."),
        (["a:=1"], "Write PACKAGE FILE"),
        (["-", "-"], "Only one file can be -"),
        (["robot", "robot.launch", ":=1"], "':=1' gives no argument a value"),
        (["robot", "robot.lanch"], "Error: there is no launch file 'robot.lanch' in package 'rob"),
        (["robot", "robot.launch"], "robot.launch:7: <node name>: the arg name has no value"),
        (["robot", "robot.launch", "name:=a b"], "<node name>: 'a b' is not a legal name"),
        (["--hub", "ws://a", "-p", "1", "robot", "robot.launch", "name:=n"], "Give the hub's"),
        (["--nope", "robot", "robot.launch"], "No such option"),
        (["--sigint-timeout", "0", "x"], "Invalid value"),
    ],
)
def test_what_cannot_be_is_said_in_a_line(words: list[str], error: str, launch: Launch) -> None:
    result = launch(*words)
    assert result.exit_code != 0
    assert error in result.stderr
    assert "Traceback" not in result.stderr


def test_an_argument_that_no_file_has_is_told(launch: Launch) -> None:
    result = launch("--nodes", "robot", "robot.launch", "name:=n", "sped:=3", "_private:=1")
    assert result.stderr == "WARNING: sped:=3: no <arg> is called sped; did you mean speed?\n"


def test_yaml_that_is_none_or_has_no_end_is_an_error(launch: Launch, robot: Path) -> None:
    file = write(robot, "<rosparam>a: [1</rosparam>")
    assert "this is no YAML: " in launch("--nodes", file).stderr
    bomb = "a: &amp;a [x]\n" + "".join(
        f"{chr(98 + n)}: &amp;{chr(98 + n)} [{', '.join(['*' + chr(97 + n)] * 10)}]\n"
        for n in range(9)
    )
    file = write(robot, f"<rosparam>{bomb}</rosparam>")
    assert f"{file}:" in (text := launch("--nodes", file).stderr) and "more than" in text


def test_its_help_says_how(launch: Launch) -> None:
    text = launch("--help").output
    assert "fibws launch fibonacci fibonacci.launch" in text
    assert "--dump-params" in text


def test_a_workspace_may_be_named_that_was_not_sourced(
    launch: Launch, robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    for name in ("FIBWS_INTERFACES", "CMAKE_PREFIX_PATH", "PYTHONPATH"):
        monkeypatch.setenv(name, "")
    words = ("--nodes", "robot", "robot.launch", "name:=n")
    assert launch(*words).exit_code == 1
    (tmp_path / "devel" / "share").mkdir(parents=True)
    assert launch(*words, "--workspace", str(tmp_path)).output == "/g/n\n"
    assert os.environ["FIBWS_INTERFACES"] == str(tmp_path / "devel" / "share")


# What is completed


def completed(words: str, launch: Launch) -> list[str]:
    result = CliRunner().invoke(
        command,
        env={
            "_FIBWS_COMPLETE": "bash_complete",
            "COMP_WORDS": f"fibws launch {words}",
            "COMP_CWORD": str(len(words.split(" ")) + 1),
        },
        prog_name="fibws",
    )
    return [line.partition(",")[2] for line in result.output.splitlines()]


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("ro", ["robot"]),
        ("robot ", ["robot.launch"]),
        ("robot robot.launch ", ["speed:=", "name:="]),
        ("robot robot.launch s", ["speed:="]),
        ("nope x", ["x"]),
        ("nope nope n", ["n"]),
    ],
)
def test_packages_files_and_arguments_are_completed(
    words: str, found: list[str], launch: Launch
) -> None:
    assert completed(words, launch) == found


# What runs


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
    with Link("test", hub) as link:
        nodes = link.call("/rosapi/nodes")["nodes"]
        assert {"/g/talker", "/g/listener"} <= set(nodes)
        assert "/numbers" in link.call("/rosapi/topics")["topics"]
        assert link.call("/rosapi/get_param", {"name": "/speed"})["value"] == "2.5"
        assert link.call("/rosapi/get_param", {"name": "/many"})["value"] == '{"a":[1]}'
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
    with Link("test", hub.url) as link:
        for name in ("/old/a", "/kept"):
            link.call("/rosapi/set_param", {"name": name, "value": "1"})
        link.call("/rosapi/set_param", {"name": "/n/gone", "value": "[1, 2]"})
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
        names = link.call("/rosapi/get_param_names")["names"]
        assert {"/old/b", "/kept", "/bytes"} <= set(names)
        assert not {"/old/a", "/n/gone"} & set(names)
        assert dumped.read_text() == "gone:\n- 1\n- 2\n"
        seen.program.send(signal.SIGTERM)
        code, err = await seen.end()
        assert code == 0
        assert "/bytes: parameters hold no bytes here, so this is their base64" in err
        assert "rosparam delete /never: it is not set" in err
        assert link.call("/rosapi/get_time")
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
    with Link("test", hub.url) as link:
        assert link.call("/rosapi/get_param", {"name": "/a"})["value"] == "1"


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
    assert err.startswith("Error: no hub can be started: ")
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
            Link("test", found[1])
    finally:
        terminal.process.kill()
        terminal.process.wait()
