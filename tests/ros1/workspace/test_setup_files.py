"""The files to source, sourced by the installed shells."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from fibws.ros1.shell.environment import set_up
from fibws.ros1.workspace.build import Workspace
from fibws.ros1.workspace.file_writer import write
from fibws.ros1.workspace.setup_files import setup_files

from .conftest import Layout

VARIABLES = ("ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH", "PYTHONPATH", "FIBWS_INTERFACES")
SHELLS = [
    pytest.param(
        shell,
        marks=pytest.mark.skipif(shutil.which(shell) is None, reason=f"{shell} is not installed"),
    )
    for shell in ("bash", "zsh", "dash")
]
FILES = {"bash": "setup.bash", "zsh": "setup.zsh", "dash": "setup.sh"}
# With a real ROS on the path, fibws would set up nothing.
PLAIN = {"PATH": os.path.dirname(sys.executable), "HOME": "/nonexistent"}


def sourced(shell: str, *folders: Path, **environment: str) -> dict[str, list[str]]:
    """Return the folders on the paths of a shell that has sourced some workspaces."""
    program = "import json, os; print(json.dumps(dict(os.environ)))"
    lines = ['. "$1"; shift' for _ in folders]
    script = "set -eu; " + "; ".join([*lines, '"$@"'])
    files = [str(folder / "devel" / FILES[shell]) for folder in folders]
    words = [str(shutil.which(shell)), "-c", script, shell, *files, sys.executable, "-c", program]
    done = subprocess.run(words, capture_output=True, text=True, env={**PLAIN, **environment})
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    found = json.loads(done.stdout)
    assert not [name for name in found if name.startswith("__fibws_path")]
    return {name: found.get(name, "").split(os.pathsep) for name in VARIABLES}


def prepared(folder: Path) -> Path:
    layout = Layout(folder)
    write(layout.devel, setup_files(layout.folder))
    return layout.folder


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.parametrize("name", ["ws", "my ws", 'it\'s "$HOME" `x` *'])
def test_sourcing_puts_the_workspace_on_the_paths(tmp_path: Path, shell: str, name: str) -> None:
    folder = prepared(tmp_path / name)
    found = sourced(shell, folder)
    assert found["ROS_PACKAGE_PATH"] == [str(folder / "src")]
    assert found["CMAKE_PREFIX_PATH"] == [str(folder / "devel")]
    assert found["FIBWS_INTERFACES"] == [str(folder / "devel" / "share")]
    assert found["PYTHONPATH"][0] == str(folder / "devel" / "lib/python3/dist-packages")


@pytest.mark.parametrize("shell", SHELLS)
def test_sourcing_sets_up_fibws(tmp_path: Path, shell: str) -> None:
    found = sourced(shell, prepared(tmp_path / "ws"))
    assert any(path.endswith(os.path.join("ros1", "python")) for path in found["PYTHONPATH"])


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.long
def test_sourcing_twice_changes_nothing(tmp_path: Path, shell: str) -> None:
    first, second = prepared(tmp_path / "a"), prepared(tmp_path / "b")
    assert sourced(shell, first, first) == sourced(shell, first)
    found = sourced(shell, first, second, first)
    assert found["ROS_PACKAGE_PATH"] == [str(first / "src"), str(second / "src")]
    # Of two folders of definitions the later one counts.
    shares = [str(second / "devel" / "share"), str(first / "devel" / "share")]
    assert found["FIBWS_INTERFACES"] == shares


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.long
def test_other_folders_stay_on_the_paths(tmp_path: Path, shell: str) -> None:
    folder = prepared(tmp_path / "ws")
    source = str(folder / "src")
    for before in ("/x:/y", f"/x:{source}:/y", f"{source}:/x:/y", f"/x:/y:{source}:{source}"):
        found = sourced(shell, folder, ROS_PACKAGE_PATH=before)
        assert found["ROS_PACKAGE_PATH"] == [source, "/x", "/y"], before


def test_underlying_workspaces_come_first(tmp_path: Path) -> None:
    below = (tmp_path / "below" / "src", tmp_path / "below" / "devel")
    text = setup_files(tmp_path / "ws", [below])["setup.bash"].content.decode()
    assert text.index(str(below[0])) < text.index(str(tmp_path / "ws" / "src"))


def test_windows_shells_have_their_own_files(tmp_path: Path) -> None:
    files = setup_files(tmp_path / "it's 100%")
    powershell = files["setup.ps1"].content.decode()
    source = str(tmp_path / "it''s 100%" / "src")
    assert f"Add-FibwsFolder ROS_PACKAGE_PATH '{source}' $false" in powershell
    batch = files["setup.bat"].content.decode()
    source = str(tmp_path / "it's 100%%" / "src")
    assert f'set "ROS_PACKAGE_PATH={source};%ROS_PACKAGE_PATH%"\r\n' in batch
    utf_8, back = batch.index("chcp 65001 >nul"), batch.index("chcp %FIBWS_CODE_PAGE% >nul")
    assert utf_8 < batch.index(source) < back, "it is read in UTF-8, and by nobody else"
    for text in (powershell, batch):
        assert str(Path("ros1", "python")) in text, "rospy is found"
        assert "FIBWS_PYTHON" in text


def test_quotation_marks_are_escaped_for_powershell(tmp_path: Path) -> None:
    powershell = setup_files(tmp_path / "it\u2019s \u2018a\u2018")["setup.ps1"].content
    assert "it\u2019\u2019s \u2018\u2018a\u2018\u2018" in powershell.decode()
    assert powershell.startswith(b"\xef\xbb\xbf"), "or else Windows reads it in its old code page"


@pytest.mark.parametrize("shadows", [False, True])
def test_workspace_of_a_shell_that_hides_an_installed_ros_hides_it_too(
    tmp_path: Path, shadows: bool
) -> None:
    layout = Layout(tmp_path / "ws")
    environment = {name: each or "" for name, each in set_up({}, shadows=shadows).items()}
    layout.package("a")
    workspace = Workspace(layout.folder, environment)
    workspace.make(workspace.plan())
    roscore = tmp_path / "ros" / "roscore"
    roscore.parent.mkdir()
    roscore.touch(mode=0o755)
    path = os.pathsep.join([str(roscore.parent), PLAIN["PATH"], "/usr/bin", "/bin"])
    script = f'. "{layout.folder}/devel/setup.bash"; command -v roscore'
    done = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, env={**PLAIN, "PATH": path}
    )
    assert (str(roscore) == done.stdout.strip()) is not shadows, done.stdout + done.stderr
