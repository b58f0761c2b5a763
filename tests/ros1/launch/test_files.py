"""The launch files that a command line names."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import WorkspaceError
from fibws.ros1.launch.files import launch_files, named
from fibws.ros1.workspace.packages import Packages

from .packages import package

EMPTY = "<launch/>"


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Packages:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "here.launch").write_text(EMPTY)
    return package(tmp_path / "src", main_launch=EMPTY, other_launch=EMPTY)


def test_a_file_is_named_by_its_path(packages: Packages) -> None:
    assert named(["here.launch"], packages) == ["here.launch"]
    assert named(["here.launch", "here.launch"], packages) == ["here.launch", "here.launch"]
    assert named(["-"], packages) == ["-"]


def test_a_file_is_named_by_its_package(packages: Packages, tmp_path: Path) -> None:
    main = str(tmp_path / "src/robot/launch/main.launch")
    assert named(["robot", "main.launch"], packages) == [main]
    assert named(["robot", "launch/main.launch", "here.launch"], packages) == [main, "here.launch"]


def test_a_package_counts_though_a_file_has_its_name(packages: Packages, tmp_path: Path) -> None:
    (tmp_path / "robot").write_text("")
    [file] = named(["robot", "main.launch"], packages)
    assert file.endswith("main.launch")


def test_the_launch_file_of_rosbridge_is_there(packages: Packages) -> None:
    [file] = named(["rosbridge_server", "rosbridge_websocket.launch"], packages)
    assert Path(file).is_file()


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["nope.launch"], "there is no file nope.launch$"),
        (
            ["main.launch"],
            "main.launch: robot has it: fibws launch robot main.launch",
        ),
        (["her.launch"], "there is no file her.launch; did you mean here.launch?"),
        (["here.launch", "nope.launch"], "there is no file nope.launch"),
        (["nope/x.launch", "here.launch"], "there is no file nope/x.launch"),
        (["robot"], "robot is a package: name a launch file of it, too; it has main.launch, oth"),
        (["robot", "mian.launch"], "no launch file 'mian.launch' in package 'robot': did you mean"),
        (["robot", "x"], "it has main.launch, other.launch"),
        (["robot", "main.launch", "nope"], "there is no file nope"),
        (
            ["robt", "main.launch"],
            "not found: robot has it: fibws launch robot main.launch",
        ),
        (["robt", "x.launch"], "package 'robt' not found: did you mean robot?"),
    ],
)
def test_a_file_that_is_not_there_is_an_error(
    words: list[str], error: str, packages: Packages
) -> None:
    with pytest.raises(WorkspaceError, match=error.replace("?", r"\?")):
        named(words, packages)


def test_of_two_files_of_one_name_one_has_to_be_chosen(packages: Packages, tmp_path: Path) -> None:
    (tmp_path / "src/robot/test").mkdir()
    (tmp_path / "src/robot/test/main.launch").write_text(EMPTY)
    with pytest.raises(WorkspaceError, match=r"write launch/main.launch, test/main.launch"):
        named(["robot", "main.launch"], packages)
    [file] = named(["robot", "test/main.launch"], packages)
    assert Path(file).parent.name == "test"


def test_the_launch_files_of_a_package_are_known(packages: Packages) -> None:
    found = launch_files(packages.find("robot").folder)
    assert [path.name for path in found] == ["main.launch", "other.launch"]
