"""The launch files that a command line names."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.errors import WorkspaceError
from fibws.ros1.launch.launch_files import find_launch_files, launch_files_in
from fibws.ros1.workspace.packages import Packages

from .packages import package

EMPTY = "<launch/>"


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Packages:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "here.launch").write_text(EMPTY)
    return package(tmp_path / "src", main_launch=EMPTY, other_launch=EMPTY)


def test_file_by_its_path(packages: Packages) -> None:
    assert find_launch_files(["here.launch"], packages) == ["here.launch"]
    assert find_launch_files(["here.launch", "here.launch"], packages) == [
        "here.launch",
        "here.launch",
    ]
    assert find_launch_files(["-"], packages) == ["-"]


def test_file_by_its_package(packages: Packages, tmp_path: Path) -> None:
    main = str(tmp_path / "src/robot/launch/main.launch")
    assert find_launch_files(["robot", "main.launch"], packages) == [main]
    assert find_launch_files(["robot", "launch/main.launch", "here.launch"], packages) == [
        main,
        "here.launch",
    ]


def test_package_precedes_a_file_of_its_name(packages: Packages, tmp_path: Path) -> None:
    (tmp_path / "robot").write_text("")
    [file] = find_launch_files(["robot", "main.launch"], packages)
    assert file.endswith("main.launch")


def test_launch_file_of_rosbridge_exists(packages: Packages) -> None:
    [file] = find_launch_files(["rosbridge_server", "rosbridge_websocket.launch"], packages)
    assert Path(file).is_file()


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["nope.launch"], "file nope.launch not found$"),
        (
            ["main.launch"],
            "fibws launch robot main.launch",
        ),
        (["her.launch"], "her.launch not found; did you mean here.launch?"),
        (["here.launch", "nope.launch"], "nope.launch not found"),
        (["nope/x.launch", "here.launch"], "nope/x.launch not found"),
        (["robot"], "package robot; it has main.launch, other.launch"),
        (["robot", "mian.launch"], "'mian.launch' .*'robot'; did you mean main.launch?"),
        (["robot", "x"], "it has main.launch, other.launch"),
        (["robot", "main.launch", "nope"], "nope not found"),
        (
            ["robt", "main.launch"],
            "robt.*fibws launch robot main.launch",
        ),
        (["robt", "x.launch"], "package 'robt' not found: did you mean robot?"),
    ],
)
def test_missing_file_is_an_error_with_a_suggestion(
    words: list[str], error: str, packages: Packages
) -> None:
    with pytest.raises(WorkspaceError, match=error.replace("?", r"\?")):
        find_launch_files(words, packages)


def test_file_of_tests_is_suggested_for_one(packages: Packages, tmp_path: Path) -> None:
    (tmp_path / "src/robot/moves.test").write_text(EMPTY)
    with pytest.raises(WorkspaceError, match=r"did you mean moves\.test\?"):
        find_launch_files(["robot", "move.test"], packages)


def test_two_files_of_one_name_are_an_error(packages: Packages, tmp_path: Path) -> None:
    (tmp_path / "src/robot/test").mkdir()
    (tmp_path / "src/robot/test/main.launch").write_text(EMPTY)
    with pytest.raises(WorkspaceError, match=r"launch/main.launch or test/main.launch"):
        find_launch_files(["robot", "main.launch"], packages)
    [file] = find_launch_files(["robot", "test/main.launch"], packages)
    assert Path(file).parent.name == "test"


def test_launch_files_of_a_package(packages: Packages) -> None:
    found = launch_files_in(packages.find("robot").folder)
    assert [path.name for path in found] == ["main.launch", "other.launch"]
