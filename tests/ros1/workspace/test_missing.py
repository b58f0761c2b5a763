"""What learners are told who ask for what is not there."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.errors import ExecutableNotFound, PackageNotFound
from fibws.ros1.workspace.packages import Packages

from .conftest import Layout

PROGRAM = "#!/usr/bin/env python3\n"
NODE = "fibonacci_broadcaster_node.py"


@pytest.fixture(autouse=True)
def bash(monkeypatch: pytest.MonkeyPatch) -> None:
    """The shell that the hints are for."""
    monkeypatch.setenv("SHELL", "/bin/bash")


def of_package(packages: Packages, name: str, program: str = "") -> str:
    with pytest.raises(PackageNotFound) as error:
        if program:
            packages.executable(name, program)
        packages.find(name)
    return str(error.value)


def of_program(packages: Packages, package: str, name: str) -> str:
    with pytest.raises(ExecutableNotFound) as error:
        packages.executable(package, name)
    return str(error.value)


def sourced(layout: Layout, here: Path | None = None) -> Packages:
    return Packages([layout.source], [layout.devel], here)


def test_the_package_that_has_the_program_is_named(layout: Layout) -> None:
    layout.package("fibonacci", programs={f"src/{NODE}": PROGRAM})
    assert of_package(sourced(layout), "fibonacci_broadcaster", NODE) == (
        f"package 'fibonacci_broadcaster' not found: fibonacci has it: rosrun fibonacci {NODE}"
    )


def test_of_several_packages_that_have_the_program_the_nearest_is_named(layout: Layout) -> None:
    for name in ("arm", "fibonacci", "gripper"):
        layout.package(name, programs={f"src/{NODE}": PROGRAM})
    text = of_package(sourced(layout), "fibonaci", NODE)
    assert text.endswith(f"fibonacci has it: rosrun fibonacci {NODE}")


def test_a_package_of_almost_that_name_is_named(layout: Layout) -> None:
    layout.package("fibonacci")
    assert of_package(sourced(layout), "fibonaci").endswith("did you mean fibonacci?")
    assert of_package(sourced(layout), "std_msg").endswith("did you mean std_msgs?")


def test_a_workspace_that_was_not_sourced_is_named(layout: Layout) -> None:
    folder = layout.package("fibonacci", programs={f"src/{NODE}": PROGRAM})
    layout.plan()
    packages = Packages([], [], here=folder)
    setup = layout.devel / "setup.bash"
    assert of_package(packages, "fibonacci").endswith(
        f"it is in the workspace {layout.folder}, which this shell does not know: source {setup}"
    )
    assert of_package(packages, "fibonacci_broadcaster", NODE).endswith(
        f"fibonacci has it, which is in the workspace {layout.folder}, which this shell does not "
        f"know: source {setup}"
    )


def test_a_workspace_that_was_not_built_is_named(layout: Layout) -> None:
    layout.package("fibonacci")
    (layout.source / "CMakeLists.txt").touch()
    packages = Packages([], [], here=layout.folder)
    assert of_package(packages, "fibonacci").endswith(
        f"it is in the workspace {layout.folder}, which is not built: "
        f"cd {layout.folder} && catkin_make && source {layout.devel / 'setup.bash'}"
    )


def test_a_workspace_that_was_moved_is_to_be_built_again(layout: Layout) -> None:
    layout.package("fibonacci")
    layout.plan()
    moved = layout.folder.rename(layout.folder.with_name("moved"))
    packages = Packages([layout.source], [layout.devel], here=moved)
    assert f"which is not built: cd {moved} && catkin_make" in of_package(packages, "fibonacci")


def test_a_path_with_a_blank_is_written_for_the_shell(tmp_path: Path) -> None:
    layout = Layout(tmp_path / "my ws")
    layout.package("fibonacci")
    layout.plan()
    packages = Packages([], [], here=layout.folder)
    assert f"source '{layout.devel / 'setup.bash'}'" in of_package(packages, "fibonacci")


def test_a_shell_without_a_workspace_is_told_so(tmp_path: Path) -> None:
    text = of_package(Packages([], [], here=tmp_path), "qwertz")
    assert text.endswith("no workspace is known in this shell: source WORKSPACE/devel/setup.bash")


def test_nothing_is_made_up(layout: Layout) -> None:
    assert of_package(sourced(layout, layout.folder), "qwertz") == "package 'qwertz' not found"


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_a_missing_executable_bit_is_told(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={f"src/{NODE}": PROGRAM})
    assert of_program(sourced(layout), "fibonacci", NODE) == (
        f"no executable {NODE!r} in package 'fibonacci': it is there, but not executable: "
        f"chmod +x {folder / 'src' / NODE}"
    )


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_a_program_of_almost_that_name_is_named(layout: Layout) -> None:
    folder = layout.package("a", files={"idle.py": ""}, programs={"talker.py": PROGRAM})
    packages = sourced(layout)
    assert of_program(packages, "a", "talker").endswith("did you mean talker.py?")
    assert of_program(packages, "a", "idel.py").endswith(
        f"did you mean idle.py? It is not executable: chmod +x {folder / 'idle.py'}"
    )
    assert of_program(packages, "a", "qwertz").endswith("it has talker.py")


def test_another_package_that_has_the_program_is_named(layout: Layout) -> None:
    layout.package("a")
    layout.package("b", programs={"talker.py": PROGRAM})
    hint = of_program(sourced(layout), "a", "talker.py")
    assert hint.endswith("b has it: rosrun b talker.py")


def test_what_is_no_program_is_told(layout: Layout) -> None:
    folder = layout.package("a", files={"data.txt": ""})
    assert of_program(sourced(layout), "a", "data.txt").endswith("it is there, but no program")
    assert of_program(sourced(layout), "a", "x").endswith(f"no program at all in {folder}")


def test_what_would_be_made_of_cpp_is_told(layout: Layout) -> None:
    layout.package(
        "a", after="add_executable(${PROJECT_NAME}_node talker.cpp)", programs={"note.py": PROGRAM}
    )
    assert of_program(sourced(layout), "a", "a_node") == (
        "no executable 'a_node' in package 'a': "
        "CMakeLists.txt, line 6, makes it of C++, which is not built here"
    )


@pytest.mark.parametrize("cmake", [None, "project("])
def test_without_a_recipe_that_can_be_read_the_rest_is_told(
    layout: Layout, cmake: str | None
) -> None:
    folder = layout.package("a", cmake=cmake, programs={"talker.py": PROGRAM})
    if cmake is None:
        (folder / "CMakeLists.txt").unlink()
    assert of_program(sourced(layout), "a", "talker").endswith("did you mean talker.py?")
