"""What a shell is given to read, read by the shells that are installed here."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path
from typing import Any

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

from fibws import __version__
from fibws.command_names import ALIASES
from fibws.ros1.shell import environment, shells
from fibws.ros1.shell.environment import BIN_FOLDER, PYTHON_FOLDER

ROOT = Path(__file__).parents[3]
SHELLS = [
    pytest.param(
        name, marks=pytest.mark.skipif(shutil.which(name) is None, reason=f"{name} is not here")
    )
    for name in ("sh", "bash", "dash", "zsh")
]
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")


def read_by(name: str, text: str, **environ: str) -> str:
    """What a shell prints that reads a text."""
    options = {"bash": ["--norc", "--noprofile"], "zsh": ["-f"]}.get(name, [])
    done = subprocess.run(
        [shutil.which(name) or name, *options, "-u", "-c", text],
        capture_output=True,
        text=True,
        env={"PATH": os.environ["PATH"], **environ},
        timeout=60,
    )
    assert done.stderr == ""
    return done.stdout


def beginning() -> str:
    return shells.begin(environment.set_up({"PATH": os.environ["PATH"]}), "", "")


@pytest.mark.parametrize("name", SHELLS)
def test_a_value_is_what_it_was_whatever_is_in_it(name: str) -> None:
    value = '/a folder/it\'s $HOME "quoted" `here`\\\n;'
    text = shells.assignments({"PYTHONPATH": value, "ROS_DISTRO": None})
    told = read_by(name, f'{text} printf %s "$PYTHONPATH${{ROS_DISTRO-none}}"', ROS_DISTRO="hydro")
    assert told == f"{value}none"


@pytest.mark.parametrize("name", SHELLS)
def test_the_commands_are_on_the_path_then_and_gone_afterwards(name: str) -> None:
    end = shells.end(environment.undo({"PATH": os.environ["PATH"]}))
    told = read_by(
        name,
        f"{beginning()}command -v rostopic; command -v roscd; echo $PYTHONPATH\n"
        f"{end}command -v roscd || echo none; echo $PATH ${{PYTHONPATH-none}}",
    )
    where, function, modules, no_function, path = told.splitlines()
    assert where == str(BIN_FOLDER / "rostopic")
    assert function == "roscd"
    assert modules == str(PYTHON_FOLDER)
    assert no_function == "none"
    assert path == f"{os.environ['PATH']} none"


@pytest.mark.parametrize("name", SHELLS)
def test_read_twice_it_can_be_taken_back_once(name: str) -> None:
    end = shells.end(environment.undo({"PATH": os.environ["PATH"]}))
    text = f"{beginning()}{beginning()}{end}command -v roscd || echo none"
    assert read_by(name, text) == "none\n"


@pytest.mark.parametrize("name", SHELLS)
def test_a_roscd_of_ones_own_is_left_alone(name: str) -> None:
    end = shells.end(environment.undo({"PATH": os.environ["PATH"]}))
    text = f"roscd() {{ echo my own; }}\n{beginning()}roscd\n{end}roscd"
    assert read_by(name, text) == "my own\nmy own\n"


@pytest.mark.parametrize("name", SHELLS)
def test_roscd_and_rosls_go_by_the_package(name: str, tmp_path: Path) -> None:
    package = tmp_path / "src" / "fibonacci"
    (package / "launch").mkdir(parents=True)
    (package / "launch" / "all.launch").touch()
    (package / "package.xml").write_text(
        "<package format='2'><name>fibonacci</name><version>0.0.0</version>"
        "<description>Numbers.</description><maintainer email='me@example.com'>Me</maintainer>"
        "<license>BSD</license></package>"
    )
    told = read_by(
        name,
        f"{beginning()}cd /; roscd fibonacci && pwd; roscd fibonacci/launch && pwd\n"
        "rosls fibonacci/launch",
        ROS_PACKAGE_PATH=str(tmp_path / "src"),
    )
    assert told.splitlines() == [str(package), str(package / "launch"), "all.launch"]


@pytest.mark.parametrize("name", SHELLS)
def test_roscd_alone_goes_to_the_workspace_that_was_sourced_last(name: str, tmp_path: Path) -> None:
    told = read_by(name, f"{beginning()}cd /; roscd && pwd", CMAKE_PREFIX_PATH=f"{tmp_path}:/usr")
    assert told == f"{tmp_path}\n"


def test_each_door_is_called_by_its_own_name() -> None:
    texts = {door.name: door.read_text() for door in BIN_FOLDER.iterdir()}
    entered = {name for name, text in texts.items() if f" -m fibws.cli {name} " in text}
    assert entered == ALIASES.keys()
    assert texts.keys() - entered == {"fibws", "rosbag", "rosdep", "rosversion"}


@pytest.mark.parametrize("door", sorted(BIN_FOLDER.iterdir()), ids=lambda door: door.name)
def test_a_door_is_thin_and_can_be_entered(door: Path) -> None:
    text = door.read_text()
    assert text.startswith("#!/bin/sh\n")
    assert len(text.splitlines()) <= 5
    assert os.access(door, os.X_OK)


@pytest.mark.parametrize("kind", [WheelBuilder, SdistBuilder])
def test_doors_can_be_entered_where_they_were_installed(
    tmp_path: Path, kind: type[WheelBuilder | SdistBuilder]
) -> None:
    for name in ("README.md", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(BIN_FOLDER, tmp_path / "fibws" / "ros1" / "shell" / "bin")
    shutil.copy(BIN_FOLDER.parent / "find_python.sh", tmp_path / "fibws" / "ros1" / "shell")
    (tmp_path / "fibws" / "__init__.py").write_text("__version__ = '1.0'")
    project = (ROOT / "pyproject.toml").read_text()
    without_page = project.replace("[tool.hatch.build.hooks.custom]", "[tool.hatch.unused]")
    (tmp_path / "pyproject.toml").write_text(without_page)
    builder: Any = kind(str(tmp_path))
    built = next(builder.build(directory=str(tmp_path / "out"), versions=["standard"]))
    if kind is WheelBuilder:
        with zipfile.ZipFile(built) as wheel:
            modes = {file.filename: file.external_attr >> 16 for file in wheel.infolist()}
    else:
        with tarfile.open(built) as sdist:
            modes = {file.name.partition("/")[2]: file.mode for file in sdist}
    assert "fibws/ros1/shell/find_python.sh" in modes
    for door in BIN_FOLDER.iterdir():
        assert modes[f"fibws/ros1/shell/bin/{door.name}"] & 0o111 == 0o111


def enter(door: str, **environ: str) -> subprocess.CompletedProcess[str]:
    path = environ.pop("PATH", os.environ["PATH"])
    return subprocess.run(
        [str(BIN_FOLDER / door), "--help"],
        capture_output=True,
        text=True,
        env={"PATH": path, **environ},
        timeout=60,
    )


def test_a_door_that_was_not_set_up_finds_a_python_that_has_fibws(tmp_path: Path) -> None:
    path = os.pathsep.join([str(Path(sys.executable).parent), *os.defpath.split(os.pathsep)])
    done = enter("rostopic", PATH=path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage: rostopic" in done.stdout


@pytest.mark.parametrize("name", ["rostopic", "rt"])
def test_a_door_may_be_entered_by_a_link(tmp_path: Path, name: str) -> None:
    (tmp_path / "first").symlink_to(BIN_FOLDER / "rostopic")
    (tmp_path / name).symlink_to("first")
    done = enter(str(tmp_path / name), FIBWS_PYTHON=sys.executable)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage: rostopic" in done.stdout


def test_a_door_that_finds_no_fibws_says_what_to_do(tmp_path: Path) -> None:
    for tool in ("sh", "dirname"):
        (tmp_path / tool).symlink_to(str(shutil.which(tool)))
    done = enter("rostopic", PATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (127, "")
    assert done.stderr == (
        "rostopic: No Python with fibws is found here. Where fibws is installed, type: "
        "source <(fibws setup)\n"
    )


def test_a_door_whose_python_is_gone_says_so() -> None:
    done = enter("rostopic", FIBWS_PYTHON="/no/such/python")
    assert (done.returncode, done.stdout) == (127, "")
    assert done.stderr.startswith("rostopic: FIBWS_PYTHON is /no/such/python, which is not there.")


@pytest.mark.parametrize(("door", "code"), [("rosdep", 0), ("rosbag", 1)])
def test_what_is_not_there_says_so(door: str, code: int) -> None:
    done = enter(door)
    assert done.returncode == code
    assert (done.stdout + done.stderr).startswith(f"{door}: fibws ")


def test_fibws_has_a_door_of_its_own() -> None:
    done = enter("fibws", FIBWS_PYTHON=sys.executable)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Usage: fibws [OPTIONS] COMMAND")


def test_rosversion_tells_the_distribution() -> None:
    for option in ("-d", "--distro"):
        told = subprocess.run(
            [str(BIN_FOLDER / "rosversion"), option],
            capture_output=True,
            text=True,
            env={"PATH": os.environ["PATH"], "FIBWS_PYTHON": sys.executable},
        )
        assert (told.stdout, told.stderr) == (f"{environment.DISTRO}\n", "")
    told = subprocess.run(
        [str(BIN_FOLDER / "rosversion"), "rospy"],
        capture_output=True,
        text=True,
        env={"PATH": os.environ["PATH"], "FIBWS_PYTHON": sys.executable},
    )
    assert (told.stdout, told.stderr) == (f"fibws {__version__}\n", "")
