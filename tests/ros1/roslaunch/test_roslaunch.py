"""Nodes and launch files that scripts start with the module roslaunch."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import roslaunch
import rosparam
from patience import PATIENCE
from ports import port as port

from fibws.client.hub_client import is_hub_running
from fibws.errors import HubError
from fibws.ros1.launch import session
from fibws.ros1.launch.runner import Runner
from fibws.ros1.workspace.packages import Packages
from fibws.testing import HubThread
from ros1.launch.packages import package

SLEEP = "#!/bin/sh\nexec sleep 600\n"
FAIL = "#!/bin/sh\nexit 3\n"
PRINT = '#!/bin/sh\necho "$SPEED in $ROS_NAMESPACE: $*"\nexec sleep 600\n'
MAIN = """<launch>
  <arg name="speed" default="1"/>
  <param name="speed" value="$(arg speed)"/>
  <node pkg="robot" type="sleep.sh" name="left"/>
  <node pkg="robot" type="sleep.sh" name="right"/>
</launch>"""
NOT_VALID = "<launch><node/></launch>"


@pytest.fixture(autouse=True)
def hub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[HubThread]:
    programs = {"sleep_sh": SLEEP, "fail_sh": FAIL, "print_sh": PRINT}
    package(tmp_path / "src", **programs, main_launch=MAIN, broken_launch=NOT_VALID)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.setenv("ROS_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("ROS_NAMESPACE", raising=False)
    with HubThread() as hub:
        monkeypatch.setenv("FIBWS_HUB", hub.url)
        yield hub


@pytest.fixture
def launch() -> Iterator[roslaunch.ROSLaunch]:
    launch = roslaunch.scriptapi.ROSLaunch()
    launch.start()
    yield launch
    launch.stop()


class Listener(roslaunch.pmon.ProcessListener):
    """Collects the processes that end."""

    def __init__(self) -> None:
        self.ended: queue.Queue[tuple[str, int | None]] = queue.Queue()

    def process_died(self, process_name: str, exit_code: int | None) -> None:
        self.ended.put((process_name, exit_code))


def file(name: str) -> str:
    [path] = roslaunch.rlutil.resolve_launch_arguments(["robot", name, "speed:=3"])
    return path


def is_running(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_launch_file_is_started_and_ended() -> None:
    uuid = roslaunch.rlutil.get_or_generate_uuid(None, False)
    roslaunch.configure_logging(uuid)
    parent = roslaunch.parent.ROSLaunchParent(uuid, [(file("main.launch"), ["speed:=7"])])
    parent.start()
    assert parent.pm is not None
    assert parent.pm.get_active_names() == ["left-1", "right-2"]
    assert rosparam.get_param("/speed") == 7
    pids = [each.pid for each in parent.pm.procs]
    parent.shutdown()
    assert not any(map(is_running, pids))
    parent.shutdown()


def test_listeners_are_told_of_ends_and_spin_returns(capfd: pytest.CaptureFixture[str]) -> None:
    text = '<launch><node pkg="robot" type="fail.sh" name="x"/></launch>'
    listener = Listener()
    parent = roslaunch.parent.ROSLaunchParent(
        "", [], roslaunch_strs=[text], process_listeners=[listener], show_summary=False
    )
    parent.start()
    parent.spin()
    assert listener.ended.get(timeout=PATIENCE) == ("x-1", 3)
    assert "exit code 3" in capfd.readouterr().err


def test_end_of_a_required_node_ends_all() -> None:
    text = """<launch>
      <node pkg="robot" type="sleep.sh" name="x"/>
      <node pkg="robot" type="fail.sh" name="y" required="true"/>
    </launch>"""
    parent = roslaunch.parent.ROSLaunchParent("", [], roslaunch_strs=[text])
    parent.start(auto_terminate=False)
    parent.spin()
    assert parent.pm is not None
    assert parent.pm.get_active_names() == []


def test_node_is_started_and_ended(
    launch: roslaunch.ROSLaunch, capfd: pytest.CaptureFixture[str]
) -> None:
    node = roslaunch.core.Node(
        "robot",
        "print.sh",
        name="x",
        namespace="ns",
        args="'a b'",
        remap_args=[("in", "out")],
        env_args=[("SPEED", "5")],
        output="screen",
    )
    process = launch.launch(node)
    assert (process.name, process.is_alive()) == ("ns/x-1", True)
    printed = ""
    while "[ns/x-1] 5 in /ns: a b in:=out __name:=x\n" not in printed:
        printed += capfd.readouterr().out  # Another thread copies what the node prints.
        time.sleep(0.01)
    process.stop()
    assert not process.is_alive()
    assert process.exit_code is not None


def test_stopped_node_is_not_started_again(launch: roslaunch.ROSLaunch) -> None:
    node = roslaunch.core.Node("robot", "sleep.sh", respawn=True)
    process = launch.launch(node)
    assert node.name is not None
    assert node.name.startswith("sleep_sh_")
    process.stop()
    assert process.is_over()


def test_other_nodes_are_refused(
    launch: roslaunch.ROSLaunch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(roslaunch.RLException, match=r"failed to launch robot/nothing\.sh"):
        launch.launch(roslaunch.Node("robot", "nothing.sh"))
    assert "sleep.sh" in capsys.readouterr().err
    with pytest.raises(ValueError, match="must be of type Node"):
        launch.launch("robot")  # type: ignore[arg-type]
    with pytest.raises(roslaunch.RLException, match="please start ROSLaunch first"):
        roslaunch.ROSLaunch().launch(roslaunch.Node("robot", "sleep.sh"))
    launch.stop()
    with pytest.raises(roslaunch.RLException, match="has ended"):
        launch.launch(roslaunch.Node("robot", "sleep.sh"))


@pytest.mark.parametrize(
    "arguments",
    [
        {"package": " "},
        {"node_type": ""},
        {"name": "a/b"},
        {"output": "both"},
        {"cwd": "home"},
        {"respawn": True, "required": True},
    ],
)
def test_node_with_invalid_attributes_is_refused(arguments: dict[str, object]) -> None:
    valid: dict[str, object] = {"package": "robot", "node_type": "sleep.sh"}
    with pytest.raises(ValueError):
        roslaunch.Node(**{**valid, **arguments})  # type: ignore[arg-type]


def test_what_cannot_be_launched_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(roslaunch.RLException, match=r"broken\.launch"):
        roslaunch.parent.ROSLaunchParent("", [file("broken.launch")]).start()
    with pytest.raises(roslaunch.RLException, match=r"nothing\.launch: No such file"):
        roslaunch.parent.ROSLaunchParent("", ["/nothing.launch"]).start()
    with pytest.raises(roslaunch.RLException, match="nothing"):
        roslaunch.rlutil.resolve_launch_arguments(["robot", "nothing.launch"])
    with pytest.raises(roslaunch.RLException, match="positive"):
        roslaunch.parent.ROSLaunchParent("", [], sigint_timeout=0)
    monkeypatch.setenv("FIBWS_HUB", "ws://robot.invalid:9090")
    with pytest.raises(roslaunch.RLException, match=r"robot\.invalid"):
        roslaunch.ROSLaunch().start()


@pytest.mark.long
def test_end_of_the_script_ends_its_nodes_and_its_hub(tmp_path: Path, port: int) -> None:
    script = tmp_path / "launcher.py"
    script.write_text(
        "import roslaunch\n"
        f"parent = roslaunch.parent.ROSLaunchParent('', [{file('main.launch')!r}], port={port})\n"
        "parent.start()\n"
        "print('pids', *(each.pid for each in parent.pm.procs))\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "fibws.rospy", str(script)],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    [pids] = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("pids ")]
    assert len(pids) == 2
    assert not any(is_running(int(pid)) for pid in pids)
    assert not is_hub_running(f"ws://127.0.0.1:{port}")


@pytest.mark.parametrize(
    ("variable", "port", "expected"),
    [
        ("ws://127.0.0.1", None, ("127.0.0.1", 80)),
        ("127.0.0.1", None, ("127.0.0.1", 9090)),
        ("", None, ("127.0.0.1", 9191)),
        ("ws://127.0.0.1", 9292, ("127.0.0.1", 9292)),
    ],
)
def test_hub_is_started_where_the_command_starts_it(
    monkeypatch: pytest.MonkeyPatch,
    variable: str,
    port: int | None,
    expected: tuple[str, int],
) -> None:
    """A launch file's port for rosbridge_websocket counts if nobody chose another one."""
    started: list[tuple[str, int]] = []

    async def start_hub(runner: Runner, host: str, port: int, options: object = ()) -> str:
        started.append((host, port))
        raise HubError("cannot start a hub")

    monkeypatch.setattr(Runner, "start_hub", start_hub)
    monkeypatch.setattr(session, "is_hub_running", lambda url, tool: False)
    monkeypatch.setenv("FIBWS_HUB", variable)
    text = """<launch><node pkg="rosbridge_server" type="rosbridge_websocket" name="bridge">
      <param name="port" value="9191"/></node></launch>"""
    parent = roslaunch.parent.ROSLaunchParent("", [], roslaunch_strs=[text], port=port)
    with pytest.raises(roslaunch.RLException, match="cannot start a hub"):
        parent.start()
    assert started == [expected]


def test_started_hub_is_the_master_of_nodes_of_an_installed_ros(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: list[object] = []

    async def start_hub(runner: Runner, host: str, port: int, options: object = ()) -> str:
        given.append(options)
        raise HubError("cannot start a hub")

    monkeypatch.setattr(Runner, "start_hub", start_hub)
    monkeypatch.setattr(session, "is_hub_running", lambda url, tool: False)
    monkeypatch.setattr(session, "master_options", lambda warn: ["--ros1", "11311"])
    monkeypatch.setattr(Packages, "installed", lambda self, package, program: True)
    text = '<launch><node pkg="turtlesim" type="turtlesim_node" name="turtle"/></launch>'
    with pytest.raises(roslaunch.RLException, match="cannot start a hub"):
        roslaunch.parent.ROSLaunchParent("", [], roslaunch_strs=[text]).start()
    assert given == [["--ros1", "11311"]]
