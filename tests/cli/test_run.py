"""``fibws run``: the programs that it runs, and its errors."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeAlias

import pytest
from click.testing import CliRunner, Result
from patience import PATIENCE

from fibws.cli import run as module
from fibws.cli.commands import command

FIBWS = [sys.executable, "-P", "-m", "fibws"]
MANIFEST = """\
<package format="2">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>Numbers.</description>
  <maintainer email="me@example.com">Me</maintainer>
  <license>BSD</license>
</package>
"""

Run: TypeAlias = Callable[..., Result]


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace with one package; its programs print what they are called with."""
    workspace = tmp_path / "ros_workspace"
    package = workspace / "src" / "fibonacci"
    (package / "src").mkdir(parents=True)
    (workspace / "src" / "CMakeLists.txt").touch()
    (package / "package.xml").write_text(MANIFEST.format(name="fibonacci"))
    listener = package / "src" / "fibonacci_listener_node.py"
    listener.write_text("#!/usr/bin/env python3\nimport sys\nprint(sys.argv[1:])\n")
    listener.chmod(0o755)
    (package / "src" / "fibonacci_broadcaster_node.py").write_text("#!/usr/bin/env python3\n")
    return workspace


@pytest.fixture
def run(tmp_path: Path, workspace: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run ``fibws run`` with the workspace on ROS_PACKAGE_PATH, and its program as a child."""

    def exec_command(words: Sequence[str]) -> None:
        done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
        print(done.stdout, end="")
        print(done.stderr, end="", file=sys.stderr)
        sys.exit(done.returncode)

    monkeypatch.setattr(module, "exec_command", exec_command)
    for name in [name for name in os.environ if name.startswith(("FIBWS", "ROS_", "CMAKE_"))]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("FIBWS_INTERFACES", "")  # Changed by --workspace.
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "")
    monkeypatch.setenv("PYTHONPATH", os.environ.get("PYTHONPATH", ""))

    def run(*words: str, cwd: Path = tmp_path, packages: str = str(workspace / "src")) -> Result:
        monkeypatch.chdir(cwd)
        monkeypatch.setenv("ROS_PACKAGE_PATH", packages)
        return CliRunner().invoke(command, ["run", *words], prog_name="fibws")

    return run


def test_arguments_after_the_program_are_passed_on(run: Run) -> None:
    done = run("fibonacci", "fibonacci_listener_node.py", "a:=b", "--help", "-x", "--", "_y:=[1]")
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout == "['a:=b', '--help', '-x', '--', '_y:=[1]']\n"


def test_script_runs_by_its_path(run: Run, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text("import rospy, sys; print(sys.argv)")
    for path in ("script.py", str(tmp_path / "script.py")):
        done = run(path, "a:=b")
        assert (done.exit_code, done.stdout) == (0, f"[{path!r}, 'a:=b']\n"), done.stderr


def test_missing_script_is_an_error(run: Run, tmp_path: Path) -> None:
    done = run("nodes/script.py")
    assert done.exit_code == 2
    assert f"{Path('nodes/script.py')} not found in {tmp_path.resolve()}" in done.stderr


def test_script_without_its_package_is_found(run: Run) -> None:
    done = run("fibonacci_listener_node.py")
    assert done.exit_code == 2
    assert " has it: fibws run fibonacci fibonacci_listener_node.py\n" in done.stderr


def test_exit_code_is_the_programs(run: Run, tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text("raise SystemExit(7)")
    assert run("script.py").exit_code == 7


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals for others")
def test_program_receives_signals(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(
        "import signal, sys\n"
        "signal.signal(signal.SIGTERM, lambda *_: sys.exit(3))\n"
        "print('waiting', flush=True)\n"
        "signal.pause()\n"
    )
    with subprocess.Popen(
        [*FIBWS, "run", "script.py"], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "waiting\n"
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE) == 3


def test_program_that_is_not_python_runs_directly(run: Run, workspace: Path) -> None:
    if sys.platform == "win32":
        pytest.skip("Windows has no sh")
    program = workspace / "src" / "fibonacci" / "scripts" / "hello"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\necho hello $1\n")
    program.chmod(0o755)
    assert run("fibonacci", "hello", "you").stdout == "hello you\n"


def test_prefix_runs_the_program(run: Run) -> None:
    done = run("--prefix", "env -u NOTHING", "fibonacci", "fibonacci_listener_node.py", "x")
    assert (done.stdout, done.stderr) == ("['x']\n", "")
    assert "--prefix: No closing quotation: 'env" in run("--prefix", "'env", "x.py").stderr


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no executable bits")
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["fibonacci_broadcaster", "fibonacci_listener_node.py"],
            " fibonacci fibonacci_listener_node.py",
        ),
        (["fibonaci", "x.py"], "did you mean fibonacci?"),
        (["fibonacci", "fibonacci_broadcaster_node.py"], "chmod +x "),
        (["fibonacci", "fibonacci_listner_node.py"], "did you mean fibonacci_listener_node.py?"),
        (["fibonacci"], "fibonacci: fibonacci_listener_node.py."),
        (["std_msgs"], "std_msgs: none"),
        ([], "PACKAGE PROGRAM"),
    ],
)
def test_error_names_the_cause(words: list[str], said: str, run: Run) -> None:
    done = run(*words)
    assert done.exit_code in (1, 2)
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_error_names_a_workspace_that_was_not_sourced(run: Run, workspace: Path) -> None:
    done = run("fibonacci", "fibonacci_listener_node.py", cwd=workspace, packages="")
    assert done.exit_code == 1
    assert "devel" in done.stderr
    assert "source" in done.stderr


def test_workspace_option_replaces_sourcing(run: Run, workspace: Path) -> None:
    program = workspace / "src" / "fibonacci" / "src" / "fibonacci_listener_node.py"
    text = "import json, os; print(json.dumps(dict(os.environ)))"
    program.write_text(f"#!/usr/bin/env python3\n{text}")
    (workspace / "devel" / "share").mkdir(parents=True)
    done = run(
        *("--workspace", str(workspace), "fibonacci", "fibonacci_listener_node.py"),
        packages="/elsewhere",
    )
    assert done.exit_code == 0, done.stderr
    environ = json.loads(done.stdout)
    assert environ["ROS_PACKAGE_PATH"] == os.pathsep.join([str(workspace / "src"), "/elsewhere"])
    assert environ["FIBWS_INTERFACES"] == str(workspace / "devel" / "share")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["rqt_graph", "rqt_graph"], ["-m", "fibws", "open", "graph"]),
        (["rqt_reconfigure", "rqt_reconfigure"], ["-m", "fibws", "open", "reconfigure"]),
        (["rqt_plot", "rqt_plot", "/a/b"], ["-m", "fibws", "open", "plot", "/a/b"]),
        (
            ["tf2_ros", "static_transform_publisher", "1", "0", "0", "0", "0", "0", "map", "odom"],
            ["-m", "fibws.programs.static_transform_publisher", *"1 0 0 0 0 0 map odom".split()],
        ),
    ],
)
def test_programs_of_ros_have_substitutes(words: list[str], line: list[str]) -> None:
    assert module._command_line(words, None) == [sys.executable, "-P", *line]


def test_program_of_ros_without_a_substitute_is_an_error(run: Run) -> None:
    done = run("rviz", "rviz")
    assert (done.exit_code, done.stdout) == (1, "")
    assert "rviz" in done.stderr and "fibws open" in done.stderr


def complete(words: str, **environ: str) -> list[str]:
    variables = {
        **environ,
        "_FIBWS_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split(" ")) - 1),
    }
    return CliRunner().invoke(command, env=variables, prog_name="fibws").output.split()


def test_packages_and_programs_are_completed(workspace: Path) -> None:
    path = {"ROS_PACKAGE_PATH": str(workspace / "src")}
    assert complete("fibws run fib", **path) == ["plain,fibonacci"]
    assert complete("fibws run ./scr", **path) == ["file,./scr"]
    assert complete("fibws run fibonacci fib", **path) == ["plain,fibonacci_listener_node.py"]
    assert complete("fibws run nothing x", **path) == []
    assert complete("fibws run fibonacci x.py some", **path) == ["file,some"]
