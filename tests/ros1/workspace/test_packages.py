"""The packages that a path leads to."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.errors import ExecutableNotFound, PackageNotFound, WorkspaceError
from fibws.ros1.workspace.packages import Packages

from .conftest import Layout

PROGRAM = "#!/usr/bin/env python3\n"


def known(layout: Layout) -> Packages:
    return Packages([layout.source], [layout.devel])


def test_packages_are_found_by_the_name_in_their_manifest(layout: Layout) -> None:
    folder = layout.package("fibonacci", folder="somewhere/else")
    package = known(layout).find("fibonacci")
    assert (package.folder, package.manifest.version) == (folder, "1.2.3")
    assert not package.is_standard


def test_the_first_of_two_of_one_name_counts(tmp_path: Path) -> None:
    first, second = Layout(tmp_path / "a"), Layout(tmp_path / "b")
    folder = first.package("fibonacci")
    second.package("fibonacci")
    assert Packages([first.source, second.source]).find("fibonacci").folder == folder


def test_what_fibws_brings_is_there_without_a_path() -> None:
    packages = Packages([])
    assert {"std_msgs", "rospy", "sensor_msgs"} <= set(packages.names())
    assert packages.find("std_msgs").is_standard
    assert (packages.find("std_msgs").folder / "msg" / "Int32.msg").is_file()
    assert packages.find("std_msgs").manifest.direct == []


def test_a_package_of_ones_own_goes_before_a_standard_one(layout: Layout) -> None:
    folder = layout.package("std_msgs")
    assert known(layout).find("std_msgs").folder == folder


def test_the_environment_tells_the_path(layout: Layout, tmp_path: Path) -> None:
    layout.package("fibonacci")
    path = os.pathsep.join([str(tmp_path / "none"), "", str(layout.source)])
    packages = Packages.from_environment(environment={"ROS_PACKAGE_PATH": path})
    assert packages.find("fibonacci").name == "fibonacci"


def test_a_workspace_may_be_named_that_was_not_sourced(layout: Layout, tmp_path: Path) -> None:
    layout.package("fibonacci")
    packages = Packages.from_environment(layout.folder, environment={})
    assert packages.find("fibonacci").name == "fibonacci"
    with pytest.raises(WorkspaceError, match="is no workspace: there is no src/ in it"):
        Packages.from_environment(tmp_path, environment={})


def test_a_program_is_what_is_executable_in_the_packages_folder(layout: Layout) -> None:
    folder = layout.package("fibonacci", programs={"src/node.py": PROGRAM})
    assert known(layout).executable("fibonacci", "node.py") == folder / "src" / "node.py"
    assert known(layout).programs(known(layout).find("fibonacci")) == ["node.py"]


def test_what_catkin_make_has_made_goes_first(layout: Layout) -> None:
    layout.package("fibonacci", programs={"src/node.py": PROGRAM})
    built = layout.devel / "lib" / "fibonacci" / "node.py"
    built.parent.mkdir(parents=True)
    built.write_text(PROGRAM)
    built.chmod(0o755)
    assert known(layout).executable("fibonacci", "node.py") == built


def test_of_two_programs_of_one_name_one_has_to_be_chosen(layout: Layout) -> None:
    folder = layout.package("a", programs={"src/node.py": PROGRAM, "scripts/node.py": PROGRAM})
    with pytest.raises(ExecutableNotFound, match=r"there are 2.*: scripts/node\.py, src/node\.py"):
        known(layout).executable("a", "node.py")
    assert known(layout).executable("a", "src/node.py") == folder / "src" / "node.py"


def test_a_link_to_a_program_is_no_second_one(layout: Layout) -> None:
    folder = layout.package("a", programs={"src/node.py": PROGRAM})
    try:
        (folder / "bin").symlink_to(folder / "src")
        (folder / "src" / "deeper").mkdir()
        (folder / "src" / "deeper" / "node.py").symlink_to(folder / "src" / "node.py")
    except OSError:
        pytest.skip("this system makes no links")
    assert known(layout).executable("a", "node.py").name == "node.py"


def test_an_unknown_package_is_an_error() -> None:
    with pytest.raises(PackageNotFound, match="package 'qwertz' not found") as error:
        Packages([]).find("qwertz")
    assert error.value.name == "qwertz"
