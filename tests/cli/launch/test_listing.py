"""``fibws launch``: listings, errors, completion."""

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


def test_arguments_are_listed(launch: Launch) -> None:
    assert launch("--ros-args", "robot", "robot.launch").output == (
        "Required Arguments:\n  name: undocumented\n"
        'Optional Arguments:\n  speed (default "2.5"): how fast\n'
    )


def test_files_are_listed(launch: Launch, robot: Path) -> None:
    file = write(
        robot, '<include file="$(dirname)/robot.launch"><arg name="name" value="n"/></include>'
    )
    assert launch("--files", file).output == f"{file}\n{robot / 'launch/robot.launch'}\n"


def test_command_of_a_node(launch: Launch, robot: Path) -> None:
    result = launch("--args", "g/n", "robot", "robot.launch", "name:=n", "-p", "1234")
    line = f"{sys.executable} -P -m fibws.rospy {robot}/scripts/waiter a 'b c' x:=y __name:=n"
    assert result.output == f"FIBWS_HUB=ws://127.0.0.1:1234 ROS_NAMESPACE=/g {line}\n"


def test_file_of_a_node(launch: Launch, robot: Path) -> None:
    for option in ("--find-node", "--find"):
        result = launch(option, "/g/n", "robot", "robot.launch", "name:=n")
        assert result.output == f"{robot / 'launch/robot.launch'}\n"


def test_unknown_node_is_an_error(launch: Launch) -> None:
    result = launch("--args", "/g/m", "robot", "robot.launch", "name:=n")
    assert result.exit_code == 1
    assert "did you mean /g/n?" in result.stderr
    assert result.stderr.endswith("\n * /g/n\n")


def test_check(launch: Launch, robot: Path) -> None:
    result = launch("--check", "robot", "robot.launch", "name:=n")
    assert result.exit_code == 0
    assert result.output.startswith("1 file, 1 node: ")
    file = write(
        robot,
        '<node pkg="robot" type="nope" name="n"/><node pkg="rosapi" type="rosapi_node" name="r"/>',
    )
    result = launch("--check", file)
    assert result.exit_code == 1
    assert f"{file}:1: <node n>: no executable 'nope' in package 'robot'" in result.output


def test_file_may_be_standard_input(launch: Launch) -> None:
    text = '<launch><node pkg="p" type="t" name="n"/></launch>'
    assert launch("--nodes", "-", input=text).output == "/n\n"


def test_everything_can_be_put_into_a_namespace(
    launch: Launch, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("--nodes", "robot", "robot.launch", "name:=n")
    assert launch(*words, "__ns:=a").output == "/a/g/n\n"
    monkeypatch.setenv("ROS_NAMESPACE", "/b")
    assert launch(*words).output == "/b/g/n\n"


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ([], "PACKAGE FILE"),
        (["a:=1"], "PACKAGE FILE"),
        (["-", "-"], "only once"),
        (["robot", "robot.launch", ":=1"], "':=1'"),
        (["robot", "robot.launch", "name=n"], "name=n is not a file; did you mean name:=n?"),
        (
            ["robot", "robot.lanch"],
            "'robot.lanch' not found in package 'robot'; did you mean ",
        ),
        (["robot", "robot.launch"], "robot.launch:7: <node name>: missing value of arg name"),
        (["robot", "robot.launch", "name:=a b"], "<node name>: 'a b' is not a legal name"),
        (["--hub", "ws://a", "-p", "1", "robot", "robot.launch", "name:=n"], "--port and --hub"),
        (["--nope", "robot", "robot.launch"], "No such option"),
        (["--sigint-timeout", "0", "x"], "Invalid value"),
    ],
)
def test_errors_are_one_line(words: list[str], error: str, launch: Launch) -> None:
    result = launch(*words)
    assert result.exit_code != 0
    assert error in result.stderr
    assert "Traceback" not in result.stderr


def test_unknown_argument_is_a_warning(launch: Launch) -> None:
    result = launch("--nodes", "robot", "robot.launch", "name:=n", "sped:=3", "_private:=1")
    assert result.stderr.startswith("WARNING: sped:=3: ")
    assert result.stderr.endswith("did you mean speed?\n")


def test_invalid_and_huge_yaml_are_errors(launch: Launch, robot: Path) -> None:
    file = write(robot, "<rosparam>a: [1</rosparam>")
    assert "Invalid YAML: " in launch("--nodes", file).stderr
    bomb = "a: &amp;a [x]\n" + "".join(
        f"{chr(98 + n)}: &amp;{chr(98 + n)} [{', '.join(['*' + chr(97 + n)] * 10)}]\n"
        for n in range(9)
    )
    file = write(robot, f"<rosparam>{bomb}</rosparam>")
    assert f"{file}:" in (text := launch("--nodes", file).stderr) and "5000000" in text


def test_help_has_examples_and_options(launch: Launch) -> None:
    text = launch("--help").output
    assert "fibws launch fibonacci fibonacci.launch" in text
    assert "--dump-params" in text


def test_workspace_option_replaces_sourcing(
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


# Completion


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
def test_completion_of_packages_files_and_arguments(
    words: str, found: list[str], launch: Launch
) -> None:
    assert completed(words, launch) == found
