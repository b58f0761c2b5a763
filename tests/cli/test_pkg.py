"""``fibws pkg``: catkin_create_pkg and rospack as they are typed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest
from click.testing import CliRunner, Result

from fibws import __version__
from fibws.cli.commands import command
from fibws.ros1.workspace.package_xml import read_manifest

Type: TypeAlias = Callable[..., Result]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder: the src/ of a sourced workspace."""
    folder = tmp_path / "ws" / "src"
    folder.mkdir(parents=True)
    monkeypatch.delenv("PWD", raising=False)
    monkeypatch.delenv("CMAKE_PREFIX_PATH", raising=False)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(folder))
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def type_(folder: Path) -> Type:
    """Type ``fibws pkg`` with these words."""

    def type_(*words: str) -> Result:
        return CliRunner().invoke(command, ["pkg", *words], prog_name="fibws")

    return type_


def test_package_is_created(folder: Path, type_: Type) -> None:
    made = type_("create", "fibonacci", "std_msgs", "rospy")
    assert made.exit_code == 0
    assert made.stderr == ""
    assert made.output.splitlines() == [
        "Created file fibonacci/package.xml",
        "Created file fibonacci/CMakeLists.txt",
        "Created folder fibonacci/src",
        f"Successfully created files in {folder / 'fibonacci'}. "
        "Please adjust the values in package.xml.",
    ]


def test_options_of_catkin_create_pkg_are_known(folder: Path, type_: Type) -> None:
    words = "-s boost eigen -b system thread -V 1.2.3 -l BSD -l MIT --rosdistro noetic".split()
    words += ["-D", "Counts & adds.", "-m", "Jane <jane@example.com>", "-a", "Joe"]
    made = type_("create", "a", "roscpp", *words)
    assert made.exit_code == 0, made.output
    manifest = read_manifest(folder / "a")
    assert (manifest.version, manifest.description) == ("1.2.3", "Counts & adds.")
    assert manifest.licenses == ("BSD", "MIT")
    assert manifest.maintainers[0].email == "jane@example.com"
    assert manifest.direct == ["boost", "eigen", "roscpp"]
    cmake = (folder / "a" / "CMakeLists.txt").read_text()
    assert "\nfind_package(Boost REQUIRED COMPONENTS system thread)\n" in cmake
    assert (folder / "a" / "include" / "a").is_dir()


def test_more_folders_are_created_if_asked_for(folder: Path, type_: Type) -> None:
    made = type_("create", "a", "--with", "launch,msg")
    assert "Created file a/launch/a.launch\n" in made.output
    assert "Created file a/msg/Num.msg\n" in made.output
    wrong = type_("create", "b", "--with", "lunch")
    assert wrong.exit_code == 2 and "'lunch'; did you mean launch?" in wrong.stderr
    assert not (folder / "b").exists()


def test_metapackage_is_created(folder: Path, type_: Type) -> None:
    type_("create", "all", "a", "b", "--meta")
    assert read_manifest(folder / "all").is_metapackage


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["a b"], "invalid name 'a b'"),
        (["there"], "File exists: "),
        (["a", "std msgs"], "invalid dependency 'std msgs'"),
    ],
)
def test_invalid_packages_are_not_created(
    folder: Path, type_: Type, words: list[str], text: str
) -> None:
    type_("create", "there")
    made = type_("create", *words)
    assert made.exit_code == 1
    assert text in made.stderr
    assert [path.name for path in folder.iterdir()] == ["there"]


def test_likely_mistakes_are_warned_of(
    folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "CMakeLists.txt").touch()
    monkeypatch.chdir(folder.parent)
    made = type_("create", "Fibonacci", "std_msg", "rospy", "my_own")
    assert made.exit_code == 0
    name, place, dependency = made.stderr.splitlines()
    assert name.startswith("Warning: ") and "lower case" in name
    assert place.endswith(f"mv Fibonacci {folder}")
    assert "std_msg " in dependency and dependency.endswith("did you mean std_msgs?")


def test_packages_are_listed_and_found(folder: Path, type_: Type) -> None:
    type_("create", "fibonacci", "rospy")
    lines = type_("list").output.splitlines()
    assert f"fibonacci {folder / 'fibonacci'}" in lines
    assert any(line.startswith("std_msgs ") for line in lines)
    names = [line.split()[0] for line in lines]
    assert type_("list", "-n").output.split() == names
    assert type_("list-names").output.split() == names
    assert type_("find", "fibonacci").output == f"{folder / 'fibonacci'}\n"
    assert type_("profile").exit_code == 0


def test_package_of_the_current_folder_is_the_default(
    folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch
) -> None:
    type_("create", "fibonacci", "rospy")
    monkeypatch.chdir(folder / "fibonacci" / "src")
    assert type_("find").output == f"{folder / 'fibonacci'}\n"
    assert type_("depends1").output == "rospy\n"
    monkeypatch.chdir(folder)
    outside = type_("find")
    assert outside.exit_code == 1 and "missing package name" in outside.stderr


def test_dependencies_are_followed(type_: Type) -> None:
    type_("create", "a", "rospy", "python3-numpy")
    type_("create", "b", "a", "std_msgs")
    type_("create", "c", "b")
    assert type_("depends1", "b").output.split() == ["a", "std_msgs"]
    assert type_("depends", "b").output.split() == ["python3-numpy", "rospy", "a", "std_msgs"]
    assert type_("depends-on1", "a").output.split() == ["b"]
    assert type_("depends-on", "a").output.split() == ["b", "c"]


def test_circle_of_dependencies_ends(type_: Type) -> None:
    type_("create", "a", "b")
    type_("create", "b", "a")
    assert type_("depends", "a").output.split() == ["b"]


def test_unknown_package_is_an_error(type_: Type) -> None:
    type_("create", "fibonacci")
    found = type_("find", "fibonaci")
    assert found.exit_code == 1
    assert found.stderr == "Error: package 'fibonaci' not found: did you mean fibonacci?\n"


def test_invalid_package_xml_is_an_error(folder: Path, type_: Type) -> None:
    type_("create", "a")
    (folder / "a" / "package.xml").write_text("<package><name>a</name></package>")
    assert type_("find", "a").exit_code == 0
    assert "a/package.xml, line 1: <version> is missing" in type_("depends1", "a").stderr


def test_names_are_completed(folder: Path, type_: Type, monkeypatch: pytest.MonkeyPatch) -> None:
    type_("create", "fibonacci")
    environment = {"_FIBWS_COMPLETE": "bash_complete", "COMP_CWORD": "3"}
    environment["COMP_WORDS"] = "fibws pkg find fibo"
    done = CliRunner().invoke(command, [], prog_name="fibws", env=environment)
    assert done.output == "plain,fibonacci\n"


def test_version_is_that_of_package_xml(folder: Path, type_: Type) -> None:
    type_("create", "fibonacci", "-V", "1.2.3")
    assert type_("version", "fibonacci").output == "1.2.3\n"
    assert type_("version", "-s", "fibonacci").output == "1.2.3"
    assert type_("version", "rospy").output == f"{__version__}\n"


def test_versions_of_all_packages(folder: Path, type_: Type) -> None:
    type_("create", "fibonacci", "-V", "1.2.3")
    (folder / "broken").mkdir()
    (folder / "broken" / "package.xml").write_text("<package>")
    lines = type_("version", "--all").output.splitlines()
    assert {"fibonacci: 1.2.3", f"std_msgs: {__version__}"} < set(lines)
    assert any(line.startswith("broken: <") for line in lines)


def test_version_of_an_unknown_package_is_an_error(type_: Type) -> None:
    done = type_("version", "fibonaci")
    assert (done.exit_code, done.stdout) == (1, "")
    assert "fibonaci" in done.stderr


def test_distribution_is_that_of_the_shell(type_: Type, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    assert type_("version", "-d").output == "noetic\n"
    monkeypatch.setenv("ROS_DISTRO", "melodic")
    assert type_("version", "--distro").output == "melodic\n"


@pytest.mark.parametrize("words", [[], ["-d", "rospy"], ["-a", "-d"]])
def test_version_needs_one_thing_to_print(type_: Type, words: list[str]) -> None:
    done = type_("version", *words)
    assert done.exit_code == 2
    assert "--distro" in done.stderr
