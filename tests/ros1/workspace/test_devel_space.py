"""The files in devel/ for a package's programs and modules."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import BIN, Layout

PROGRAM = """\
#!/usr/bin/env python3
import sys
import beside

class Kept:
    pass

if __name__ == "__main__":
    print(beside.WORD, __file__, sys.argv[1:], Kept.__module__)
    raise SystemExit(3)
"""
SETUP = """\
from distutils.core import setup
from catkin_pkg.python_setup import generate_distutils_setup
setup(**generate_distutils_setup(packages=['mine'], package_dir={'': 'src'}, py_modules=['one']))
"""


def run(*words: str | Path, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    environment = {"PYTHONPATH": str(path)} if path else {}
    return subprocess.run(
        [sys.executable, *map(str, words)], capture_output=True, text=True, env=environment
    )


def with_program(layout: Layout) -> Path:
    return layout.package(
        "a",
        after=f"catkin_install_python(PROGRAMS scripts/node.py DESTINATION {BIN})",
        programs={"scripts/node.py": PROGRAM},
        files={"scripts/beside.py": "WORD = 'hello'\n"},
    )


@pytest.mark.parametrize("name", ["ws", "my ws", 'it\'s "mine"', "naïve"])
def test_program_runs_as_if_started_directly(tmp_path: Path, name: str) -> None:
    layout = Layout(tmp_path / name)
    folder = with_program(layout)
    assert not layout.plan().errors
    relay = layout.devel / "lib" / "a" / "node.py"
    done = run(relay, "x", "y")
    program = folder / "scripts" / "node.py"
    assert done.stdout == f"hello {program} ['x', 'y'] __main__\n", done.stderr
    assert done.returncode == 3


@pytest.mark.skipif(sys.platform == "win32", reason="Windows reads no first line")
def test_program_is_executable_by_itself(layout: Layout) -> None:
    with_program(layout)
    layout.plan()
    done = subprocess.run([layout.devel / "lib" / "a" / "node.py"], capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()[0]) == (3, "hello")


def test_changed_program_needs_no_new_build(layout: Layout) -> None:
    folder = with_program(layout)
    layout.plan()
    (folder / "scripts" / "node.py").write_text("print('changed')")
    assert run(layout.devel / "lib" / "a" / "node.py").stdout == "changed\n"


def test_modules_of_setup_py_can_be_imported(layout: Layout) -> None:
    layout.package(
        "mine",
        before="catkin_python_setup()",
        files={
            "setup.py": SETUP,
            "src/mine/__init__.py": "NAME = __name__\nHERE = __file__\n",
            "src/mine/deeper/__init__.py": "",
            "src/mine/deeper/most.py": "X = 1\n",
            "src/one.py": "Y = __name__\n",
        },
    )
    assert not layout.plan().errors
    program = "import mine, one; from mine.deeper import most; print(mine.NAME, mine.HERE, one.Y)"
    done = run("-c", program, path=layout.devel / "lib/python3/dist-packages")
    init = layout.source / "mine" / "src" / "mine" / "__init__.py"
    assert done.stdout == f"mine {init} one\n", done.stderr


def test_missing_folder_of_setup_py_gives_a_warning(layout: Layout) -> None:
    files = {"setup.py": SETUP, "src/one.py": ""}
    layout.package("mine", before="catkin_python_setup()", files=files)
    plan = layout.plan()
    assert plan.errors == []
    (warning,) = plan.warnings
    assert "setup.py, line 3: " in warning and "src/mine" in warning
    assert "lib/python3/dist-packages/one.py" in plan.trees["mine"]
