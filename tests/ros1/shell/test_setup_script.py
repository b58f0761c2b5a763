"""The scripts of ``fibws setup`` and the commands in bin/, run by the shells of this machine."""

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

from fibws.command_names import ALIASES
from fibws.ros1.shell import environment, setup_script
from fibws.ros1.shell.environment import BIN_FOLDER, PYTHON_FOLDER

ROOT = Path(__file__).parents[3]
SHELLS = [
    pytest.param(
        name, marks=pytest.mark.skipif(shutil.which(name) is None, reason=f"{name} is not here")
    )
    for name in ("sh", "bash", "dash", "zsh")
]
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such shells")


def run_in(name: str, script: str, **environ: str) -> str:
    """Run a script in a shell; return what it prints."""
    options = {"bash": ["--norc", "--noprofile"], "zsh": ["-f"]}.get(name, [])
    done = subprocess.run(
        [shutil.which(name) or name, *options, "-u", "-c", script],
        capture_output=True,
        text=True,
        env={"PATH": os.environ["PATH"], **environ},
        timeout=60,
    )
    assert done.stderr == ""
    return done.stdout


def set_up() -> str:
    return setup_script.set_up(environment.set_up({"PATH": os.environ["PATH"]}), "", "")


@pytest.mark.parametrize("name", SHELLS)
def test_values_are_quoted(name: str) -> None:
    value = '/a folder/it\'s $HOME "quoted" `here`\\\n;'
    text = setup_script.assignments({"PYTHONPATH": value, "ROS_DISTRO": None})
    out = run_in(name, f'{text} printf %s "$PYTHONPATH${{ROS_DISTRO-none}}"', ROS_DISTRO="hydro")
    assert out == f"{value}none"


@pytest.mark.parametrize("name", SHELLS)
def test_commands_are_on_the_path_until_undo(name: str) -> None:
    end = setup_script.undo(environment.undo({"PATH": os.environ["PATH"]}))
    out = run_in(
        name,
        f"{set_up()}command -v rostopic; command -v roscd; echo $PYTHONPATH\n"
        f"{end}command -v roscd || echo none; echo $PATH ${{PYTHONPATH-none}}",
    )
    where, function, modules, no_function, path = out.splitlines()
    assert where == str(BIN_FOLDER / "rostopic")
    assert function == "roscd"
    assert modules == str(PYTHON_FOLDER)
    assert no_function == "none"
    assert path == f"{os.environ['PATH']} none"


@pytest.mark.parametrize("name", SHELLS)
def test_setup_done_twice_is_undone_once(name: str) -> None:
    end = setup_script.undo(environment.undo({"PATH": os.environ["PATH"]}))
    text = f"{set_up()}{set_up()}{end}command -v roscd || echo none"
    assert run_in(name, text) == "none\n"


@pytest.mark.parametrize("name", SHELLS)
def test_existing_roscd_is_kept(name: str) -> None:
    end = setup_script.undo(environment.undo({"PATH": os.environ["PATH"]}))
    text = f"roscd() {{ echo my own; }}\n{set_up()}roscd\n{end}roscd"
    assert run_in(name, text) == "my own\nmy own\n"


@pytest.mark.parametrize("name", SHELLS)
@pytest.mark.long
def test_roscd_and_rosls_find_packages(name: str, tmp_path: Path) -> None:
    package = tmp_path / "src" / "fibonacci"
    (package / "launch").mkdir(parents=True)
    (package / "launch" / "all.launch").touch()
    (package / "package.xml").write_text(
        "<package format='2'><name>fibonacci</name><version>0.0.0</version>"
        "<description>Numbers.</description><maintainer email='me@example.com'>Me</maintainer>"
        "<license>BSD</license></package>"
    )
    out = run_in(
        name,
        f"{set_up()}cd /; roscd fibonacci && pwd; roscd fibonacci/launch && pwd\n"
        "rosls fibonacci/launch",
        ROS_PACKAGE_PATH=str(tmp_path / "src"),
    )
    assert out.splitlines() == [str(package), str(package / "launch"), "all.launch"]


@pytest.mark.parametrize("name", SHELLS)
def test_roscd_without_a_package_goes_to_the_last_workspace(name: str, tmp_path: Path) -> None:
    out = run_in(name, f"{set_up()}cd /; roscd && pwd", CMAKE_PREFIX_PATH=f"{tmp_path}:/usr")
    assert out == f"{tmp_path}\n"


def test_each_alias_has_a_program() -> None:
    texts = {program.name: program.read_text() for program in BIN_FOLDER.iterdir()}
    found = {name for name, text in texts.items() if f" -m fibws.cli {name} " in text}
    assert found == ALIASES.keys()
    assert texts.keys() - found == {"fibws", "rosdep"}


def test_programs_are_executable_scripts() -> None:
    for program in BIN_FOLDER.iterdir():
        assert program.read_text().startswith("#!/bin/sh\n"), program.name
        assert os.access(program, os.X_OK), program.name


@pytest.mark.parametrize("kind", [WheelBuilder, SdistBuilder])
def test_installed_programs_are_executable(
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
    for program in BIN_FOLDER.iterdir():
        assert modes[f"fibws/ros1/shell/bin/{program.name}"] & 0o111 == 0o111


def run_help(program: str, **environ: str) -> subprocess.CompletedProcess[str]:
    path = environ.pop("PATH", os.environ["PATH"])
    return subprocess.run(
        [str(BIN_FOLDER / program), "--help"],
        capture_output=True,
        text=True,
        env={"PATH": path, **environ},
        timeout=60,
    )


def test_program_without_setup_finds_a_python_with_fibws() -> None:
    path = os.pathsep.join([str(Path(sys.executable).parent), *os.defpath.split(os.pathsep)])
    done = run_help("rostopic", PATH=path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage: rostopic" in done.stdout


@pytest.mark.parametrize("name", ["rostopic", "rt"])
def test_program_runs_through_a_link(tmp_path: Path, name: str) -> None:
    (tmp_path / "first").symlink_to(BIN_FOLDER / "rostopic")
    (tmp_path / name).symlink_to("first")
    done = run_help(str(tmp_path / name), FIBWS_PYTHON=sys.executable)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage: rostopic" in done.stdout


def test_program_without_fibws_is_an_error(tmp_path: Path) -> None:
    for tool in ("sh", "dirname"):
        (tmp_path / tool).symlink_to(str(shutil.which(tool)))
    done = run_help("rostopic", PATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (127, "")
    assert done.stderr.startswith("rostopic: ")
    assert "source <(fibws setup)" in done.stderr


def test_program_whose_python_is_missing_is_an_error() -> None:
    done = run_help("rostopic", FIBWS_PYTHON="/no/such/python")
    assert (done.returncode, done.stdout) == (127, "")
    assert done.stderr.startswith("rostopic: FIBWS_PYTHON is /no/such/python")


def test_unsupported_program_says_so() -> None:
    done = run_help("rosdep", PATH=str(BIN_FOLDER))
    assert done.returncode == 0
    assert (done.stdout + done.stderr).startswith("rosdep: fibws ")


@pytest.mark.parametrize("has_link", [False, True])
def test_installed_rosdep_is_run(tmp_path: Path, has_link: bool) -> None:
    installed, links = tmp_path / "installed", tmp_path / "links"
    installed.mkdir()
    links.mkdir()
    (installed / "rosdep").write_text('#!/bin/sh\necho installed "$#" "$@"')
    (installed / "rosdep").chmod(0o755)
    if has_link:
        (links / "rosdep").symlink_to(BIN_FOLDER / "rosdep")
    path = os.pathsep.join([*map(str, [links, BIN_FOLDER, installed]), os.defpath])
    done = run_help(str(links / "rosdep") if has_link else "rosdep", PATH=path)
    assert (done.stdout, done.stderr) == ("installed 1 --help\n", "")


def test_rosdep_skips_the_packages_of_fibws(tmp_path: Path) -> None:
    (tmp_path / "rosdep").write_text('#!/bin/sh\nprintf "%s\\n" "$@"')
    (tmp_path / "rosdep").chmod(0o755)
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    changes = environment.set_up({"PATH": path, "PYTHONPATH": str(ROOT)})
    out = run_in("sh", f"{setup_script.set_up(changes, '', '')}rosdep install a 'b c'")
    *words, skip, names = out.splitlines()
    assert words == ["install", "a", "b c"]
    assert skip == "--skip-keys"
    assert {"rospy", "std_msgs", "catkin", "roscpp"} <= set(names.split())


def test_fibws_itself_is_on_the_path() -> None:
    done = run_help("fibws", FIBWS_PYTHON=sys.executable)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Usage: fibws [OPTIONS] COMMAND")
