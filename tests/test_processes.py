"""Command lines of programs, and execution of one in place of this process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fibws.processes import command_line, exec_command, is_python


@pytest.mark.parametrize(
    "first_line",
    [
        "#!/usr/bin/env python3",
        "#!/usr/bin/env python",
        "#! /usr/bin/python3.11 -u",
        "#!/home/me/venv/bin/python",
        "#!/usr/bin/env -S python3 -u",
    ],
)
def test_python_script_is_recognized_by_its_first_line(tmp_path: Path, first_line: str) -> None:
    script = tmp_path / "listener"
    script.write_text(f"{first_line}\nprint('python')\n")
    assert is_python(script)


@pytest.mark.parametrize(
    "text", ["#!/bin/sh\npython x.py\n", "#!/usr/bin/env bash\n", "#!/usr/bin/pythonic", "", "\0\1"]
)
def test_other_programs_are_not_python(tmp_path: Path, text: str) -> None:
    program = tmp_path / "program"
    program.write_text(text)
    assert not is_python(program)
    assert command_line(program, ["a", "b:=c"]) == [str(program), "a", "b:=c"]


def test_python_script_runs_in_this_python_with_rospy(tmp_path: Path) -> None:
    script = tmp_path / "node.py"
    assert command_line(script, ["numbers:=fibonacci"]) == [
        *(sys.executable, "-P", "-m", "fibws.rospy"),
        *(str(script), "numbers:=fibonacci"),
    ]


def test_module_in_the_current_folder_does_not_replace_pythons(tmp_path: Path) -> None:
    (tmp_path / "random.py").write_text("raise SystemExit('this is not the random that was meant')")
    node = tmp_path / "nodes" / "node.py"
    node.parent.mkdir()
    node.write_text("import random; print(random.choice([8]))")
    done = subprocess.run(command_line(node, []), cwd=tmp_path, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("8\n", "")


def test_missing_program_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        command_line(tmp_path / "listener", [])


def run_exec(command: list[str], *, windows: bool) -> subprocess.CompletedProcess[str]:
    on = "import os; os.name = 'nt'; " if windows else ""
    program = (
        f"{on}print('before'); from fibws.processes import exec_command; exec_command({command!r})"
    )
    line = [sys.executable, "-c", program]
    return subprocess.run(line, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize(
    "windows",
    [
        pytest.param(
            False, marks=pytest.mark.skipif(sys.platform == "win32", reason="Windows has no exec")
        ),
        True,
    ],
)
def test_program_replaces_this_process(windows: bool) -> None:
    code = "print('after'); raise SystemExit(5)"
    done = run_exec([sys.executable, "-c", code], windows=windows)
    assert (done.returncode, done.stdout, done.stderr) == (5, "before\nafter\n", "")


def test_missing_command_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OSError):
        exec_command([str(tmp_path / "nothing")])


@pytest.mark.skipif(os.name == "nt", reason="Windows knows programs by their suffixes")
@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("print('hello')\n", "#!/usr/bin/env python3"),
        ("#!/no/such/shell\n", "[Ii]nterpreter"),
    ],
)
def test_start_error_names_the_program_and_the_reason(
    tmp_path: Path, text: str, error: str
) -> None:
    program = tmp_path / "node"
    program.write_text(text)
    program.chmod(0o755)
    with pytest.raises(OSError, match=error) as raised:
        exec_command([str(program)])
    assert raised.value.filename == str(program)
    with pytest.raises(FileNotFoundError, match="No such file") as missing:
        exec_command(["no_such_program", "x"])
    assert missing.value.filename == "no_such_program"
