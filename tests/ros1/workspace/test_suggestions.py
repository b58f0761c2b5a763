"""Suggestions in errors about packages and programs that are not found."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.command_names import SETUP
from fibws.ros1.errors import ExecutableNotFound, PackageNotFound
from fibws.ros1.workspace.packages import Packages

from .conftest import Layout
from .test_package_checks import needs_executable_bit

PROGRAM = "#!/usr/bin/env python3\n"
NODE = "fibonacci_broadcaster_node.py"


@pytest.fixture(autouse=True)
def bash(monkeypatch: pytest.MonkeyPatch) -> None:
    """A shell with ROS's commands."""
    monkeypatch.setenv("SHELL", "/bin/bash")
    monkeypatch.setenv(SETUP, "{}")


def of_package(packages: Packages, name: str, program: str = "") -> str:
    with pytest.raises(PackageNotFound) as error:
        if program:
            packages.executable(name, program)
        packages.find(name)
    assert error.value.name == name
    return error.value.hint


def of_program(packages: Packages, package: str, name: str) -> str:
    with pytest.raises(ExecutableNotFound) as error:
        packages.executable(package, name)
    return error.value.hint


def sourced(layout: Layout, here: Path | None = None) -> Packages:
    return Packages([layout.source], [layout.devel], here)


def test_package_that_has_the_program_is_suggested(layout: Layout) -> None:
    layout.package("fibonacci", programs={f"src/{NODE}": PROGRAM})
    suggestion = of_package(sourced(layout), "fibonacci_broadcaster", NODE)
    assert suggestion.endswith(f"rosrun fibonacci {NODE}")


def test_commands_are_named_as_in_this_shell(
    layout: Layout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(SETUP)
    layout.package("fibonacci", programs={f"src/{NODE}": PROGRAM})
    assert of_package(sourced(layout), "x", NODE).endswith(f"fibws run fibonacci {NODE}")
    (layout.source / "CMakeLists.txt").touch()
    assert "&& fibws workspace make &&" in of_package(Packages([], [], layout.folder), "fibonacci")


def test_of_several_packages_that_have_the_program_the_nearest_is_suggested(
    layout: Layout,
) -> None:
    for name in ("arm", "fibonacci", "gripper"):
        layout.package(name, programs={f"src/{NODE}": PROGRAM})
    assert of_package(sourced(layout), "fibonaci", NODE).endswith(f"rosrun fibonacci {NODE}")


def test_package_of_a_similar_name_is_suggested(layout: Layout) -> None:
    layout.package("fibonacci")
    assert of_package(sourced(layout), "fibonaci") == "did you mean fibonacci?"
    assert of_package(sourced(layout), "std_msg") == "did you mean std_msgs?"


def test_sourcing_the_workspace_is_suggested(layout: Layout) -> None:
    folder = layout.package("fibonacci", programs={f"src/{NODE}": PROGRAM})
    layout.plan()
    packages = Packages([], [], here=folder)
    setup = layout.devel / "setup.bash"
    suggestion = of_package(packages, "fibonacci")
    assert str(layout.folder) in suggestion and suggestion.endswith(f": source {setup}")
    suggestion = of_package(packages, "fibonacci_broadcaster", NODE)
    assert suggestion.startswith("fibonacci ") and suggestion.endswith(f": source {setup}")


def test_building_the_workspace_is_suggested(layout: Layout) -> None:
    layout.package("fibonacci")
    (layout.source / "CMakeLists.txt").touch()
    suggestion = of_package(Packages([], [], here=layout.folder), "fibonacci")
    setup = layout.devel / "setup.bash"
    assert suggestion.endswith(f": cd {layout.folder} && catkin_make && source {setup}")


def test_building_a_moved_workspace_is_suggested(layout: Layout) -> None:
    layout.package("fibonacci")
    layout.plan()
    moved = layout.folder.rename(layout.folder.with_name("moved"))
    packages = Packages([layout.source], [layout.devel], here=moved)
    assert f": cd {moved} && catkin_make" in of_package(packages, "fibonacci")


def test_path_with_a_blank_is_quoted(tmp_path: Path) -> None:
    layout = Layout(tmp_path / "my ws")
    layout.package("fibonacci")
    layout.plan()
    packages = Packages([], [], here=layout.folder)
    assert f"source '{layout.devel / 'setup.bash'}'" in of_package(packages, "fibonacci")


def test_sourcing_is_suggested_in_a_shell_without_a_workspace(tmp_path: Path) -> None:
    suggestion = of_package(Packages([], [], here=tmp_path), "qwertz")
    assert "source WORKSPACE/devel/setup.bash" in suggestion


def test_nothing_is_suggested_if_nothing_is_similar(layout: Layout) -> None:
    assert of_package(sourced(layout, layout.folder), "qwertz") == ""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_making_a_program_executable_is_suggested(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={f"src/{NODE}": PROGRAM})
    suggestion = of_program(sourced(layout), "fibonacci", NODE)
    assert suggestion.endswith(f"chmod +x {folder / 'src' / NODE}")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_program_of_a_similar_name_is_suggested(layout: Layout) -> None:
    folder = layout.package("a", files={"idle.py": ""}, programs={"talker.py": PROGRAM})
    packages = sourced(layout)
    assert of_program(packages, "a", "talker") == "did you mean talker.py?"
    idle = of_program(packages, "a", "idel.py")
    assert "mean idle.py?" in idle and idle.endswith(f"chmod +x {folder / 'idle.py'}")
    assert of_program(packages, "a", "qwertz") == "it has talker.py"


def test_another_package_that_has_the_program_is_suggested(layout: Layout) -> None:
    layout.package("a")
    layout.package("b", programs={"talker.py": PROGRAM})
    assert of_program(sourced(layout), "a", "talker.py").endswith("rosrun b talker.py")


def test_file_that_is_not_a_program_is_named(layout: Layout) -> None:
    folder = layout.package("a", files={"data.txt": ""})
    assert "not a program" in of_program(sourced(layout), "a", "data.txt")
    assert of_program(sourced(layout), "a", "x").endswith(f"no programs in {folder}")


def test_cpp_program_is_named_with_its_line(layout: Layout) -> None:
    layout.package(
        "a", after="add_executable(${PROJECT_NAME}_node talker.cpp)", programs={"note.py": PROGRAM}
    )
    suggestion = of_program(sourced(layout), "a", "a_node")
    assert "C++" in suggestion and "line 6" in suggestion


@pytest.mark.parametrize("cmake", [None, "project("])
def test_without_a_valid_cmake_lists_programs_are_suggested(
    layout: Layout, cmake: str | None
) -> None:
    folder = layout.package("a", cmake=cmake, programs={"talker.py": PROGRAM})
    if cmake is None:
        (folder / "CMakeLists.txt").unlink()
    assert of_program(sourced(layout), "a", "talker") == "did you mean talker.py?"


@needs_executable_bit
@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("import rospy\n", "#!/usr/bin/env python3"),
        ("#!/usr/bin/env python3\r\nimport rospy\r\n", "CRLF"),
    ],
)
def test_program_that_a_shell_would_run_is_refused(layout: Layout, text: str, fact: str) -> None:
    folder = layout.package("fibonacci", programs={f"src/{NODE}": ""})
    (folder / "src" / NODE).write_bytes(text.encode())
    suggestion = of_program(sourced(layout), "fibonacci", NODE)
    assert suggestion.startswith(f"{folder / 'src' / NODE}, line 1") and fact in suggestion


@needs_executable_bit
def test_programs_that_are_not_executable_are_named(layout: Layout) -> None:
    node = f"{PROGRAM}rospy.init_node('a')\n"
    folder = layout.package("fibonacci", files={"src/a_node.py": node, "src/b_node.py": node})
    suggestion = of_program(sourced(layout), "fibonacci", "broadcaster")
    assert suggestion.endswith(f"chmod +x {folder}/src/a_node.py {folder}/src/b_node.py")
