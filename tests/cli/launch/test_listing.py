"""``fibws launch``: what it lists, refuses and completes."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from fibws.cli.commands import command

from .conftest import Launch, write


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
