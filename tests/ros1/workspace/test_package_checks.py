"""Warnings about packages."""

from __future__ import annotations

import os
from importlib import metadata

import pytest

from fibws.ros1.workspace.packages import Packages
from fibws.ros1.workspace.packages_outside_fibws import NOT_NEEDED, REPOSITORIES, pip_name

from .conftest import BIN, Layout

PROGRAM = "#!/usr/bin/env python3\n"
needs_executable_bit = pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")


def test_good_package_has_no_warnings(layout: Layout) -> None:
    layout.package(
        "fibonacci",
        *("rospy", "std_msgs"),
        after=f"catkin_install_python(PROGRAMS src/node.py DESTINATION {BIN})",
        programs={"src/node.py": PROGRAM},
    )
    assert layout.warnings() == []


def test_another_name_of_the_project_is_warned_of(layout: Layout) -> None:
    layout.package("a", cmake="project(b)\nfind_package(catkin)\ncatkin_package()")
    (warning,) = layout.warnings()
    assert warning.startswith("a/CMakeLists.txt, line 1: ") and "project(a)" in warning


def test_ros_2_package_is_an_error(layout: Layout) -> None:
    layout.package("a", manifest="<export><build_type>ament_python</build_type></export>")
    (error,) = layout.errors()
    assert error.startswith("a/package.xml, line 3: ") and "ament_python" in error


@pytest.mark.parametrize(
    ("dependency", "fact"),
    [
        ("geometry_msg", "did you mean geometry_msgs?"),
        ("teleop_twist_keyboard", "https://github.com/ros-teleop/teleop_twist_keyboard"),
        ("somebodys_robot_driver", "put its source into src/"),
        ("python3-serial", "pip install pyserial"),
        ("xacro", "pip install xacro"),
    ],
)
def test_missing_dependency_is_a_warning_with_what_would_install_it(
    layout: Layout, monkeypatch: pytest.MonkeyPatch, dependency: str, fact: str
) -> None:
    def nothing_is_installed(name: str) -> None:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "distribution", nothing_is_installed)
    layout.package("a", manifest=f"\n\n<depend>{dependency}</depend>")
    layout.package("b", manifest=f"<exec_depend>{dependency}</exec_depend>")
    (warning,) = layout.warnings()
    assert warning.startswith(f"a/package.xml, line 11: package {dependency} not found")
    assert "needed by b" in warning and fact in warning
    assert "share/a/package.xml" in layout.built()


def test_dependencies_of_cmake_lists_are_looked_for_too(layout: Layout) -> None:
    layout.package(
        "a",
        cmake="find_package(catkin REQUIRED rospy std_msg)\n"
        "generate_messages(DEPENDENCIES std_msgs my_msgs)",
    )
    first, second = layout.warnings()
    assert first.startswith("a/CMakeLists.txt, line 1: ") and "std_msgs" in first
    assert second.startswith("a/CMakeLists.txt, line 2: ") and "my_msgs" in second


def test_dependencies_that_exist_or_are_not_needed_are_not_warned_of(layout: Layout) -> None:
    names = ["catkin", "message_generation", "roscpp", "boost", "libusb-1.0-dev", "nodelet", "tf2"]
    names += ["python3-pytest", "rospy", "move_base_msgs", "control_msgs", "b", "eigen"]
    layout.package("a", manifest="".join(f"<depend>{name}</depend>" for name in names))
    layout.package("b", manifest="<test_depend>rostest_of_others</test_depend>")
    assert layout.warnings() == []


def test_packages_of_fibws_are_not_listed_as_outside() -> None:
    assert not {*Packages([]).names()} & REPOSITORIES.keys()
    assert not NOT_NEEDED & REPOSITORIES.keys()


@pytest.mark.parametrize(
    ("dependency", "name"),
    [
        ("python3-numpy", "numpy"),
        ("python-yaml", "pyyaml"),
        ("python3-some-thing-pip", "some-thing"),
        ("python3-unknown", None),
        ("boost", None),
    ],
)
def test_keys_of_rosdep_have_names_in_pypi(dependency: str, name: str | None) -> None:
    assert pip_name(dependency) == name


@needs_executable_bit
def test_program_that_is_not_executable_is_warned_of(layout: Layout) -> None:
    layout.package(
        "a",
        after=f"catkin_install_python(PROGRAMS src/node.py DESTINATION {BIN})",
        files={"src/node.py": PROGRAM, "src/other.py": PROGRAM, "src/module.py": "x = 1\n"},
    )
    node, other = layout.warnings()
    assert node.startswith("a/CMakeLists.txt, line 6: ") and "chmod +x a/src/node.py" in node
    assert other.startswith("a/src/other.py ") and "chmod +x a/src/other.py" in other
    assert "lib/a/node.py" in layout.built()


def test_program_without_a_shebang_is_warned_of(layout: Layout) -> None:
    layout.package(
        "a",
        after=f"catkin_install_python(PROGRAMS node.py DESTINATION {BIN})",
        programs={"node.py": "print()\n"},
    )
    (warning,) = layout.warnings()
    assert "node.py" in warning and "#!/usr/bin/env python3" in warning


@needs_executable_bit
def test_program_without_a_shebang_that_is_not_installed_is_warned_of(layout: Layout) -> None:
    node = "import rospy\nrospy.init_node('node')\n"
    layout.package(
        "a",
        files={"src/idle.py": node, "src/a/__init__.py": "", "src/a/module.py": node, "x.py": "1"},
        programs={"src/node.py": node, "src/data.csv": "1,2", "run.sh": "#!/bin/sh\n"},
    )
    executable, shebang, other = layout.warnings()
    assert executable.startswith("a/src/idle.py ") and "chmod +x a/src/idle.py" in executable
    for warning, path in ((shebang, "a/src/idle.py"), (other, "a/src/node.py")):
        assert warning.startswith(f"{path}, line 1") and "#!/usr/bin/env python3" in warning


def test_two_programs_of_one_name_are_warned_of(layout: Layout) -> None:
    installed = "\n".join(
        f"catkin_install_python(PROGRAMS {files} DESTINATION {BIN})"
        for files in ("old/node.py old/node.py", "src/node.py")
    )
    programs = {"old/node.py": PROGRAM, "src/node.py": PROGRAM}
    folder = layout.package("a", after=installed, programs=programs)
    (warning,) = layout.warnings()
    assert warning.startswith("a/CMakeLists.txt, line 7: a/src/node.py replaces a/old/node.py")
    program = (layout.devel / "lib" / "a" / "node.py").read_text()
    assert str(folder / "src" / "node.py") in program


@needs_executable_bit
def test_windows_line_endings_of_a_program_are_warned_of(layout: Layout) -> None:
    folder = layout.package("a", programs={"node.py": "", "unix.py": PROGRAM})
    (folder / "node.py").write_bytes(PROGRAM.replace("\n", "\r\n").encode())
    (warning,) = layout.warnings()
    assert warning.startswith("a/node.py, line 1: ") and "CRLF" in warning


def test_all_cpp_programs_are_one_warning(layout: Layout) -> None:
    layout.package("a", "roscpp", after="add_executable(node src/node.cpp)\nadd_library(lib x.cpp)")
    layout.package("b", after="add_library(b INTERFACE)")
    layout.package("c", "roscpp", after="add_executable(node src/node.cpp)")
    (warning,) = layout.warnings()
    assert "C++" in warning and "3 targets" in warning and warning.endswith("a, c")
