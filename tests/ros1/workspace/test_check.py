"""Whether the files of a package say the same."""

from __future__ import annotations

import os

import pytest

from fibws.ros1.workspace.elsewhere import ELSEWHERE, MODULES, PROVIDED

from .conftest import BIN, Layout, manifest_of

PROGRAM = "#!/usr/bin/env python3\n"
needs_bit = pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")


def test_a_good_package_has_no_faults_and_no_warnings(layout: Layout) -> None:
    layout.package(
        "fibonacci",
        *("rospy", "std_msgs"),
        after=f"catkin_install_python(PROGRAMS src/node.py DESTINATION {BIN})",
        programs={"src/node.py": PROGRAM},
    )
    assert layout.warnings() == []


def test_both_files_name_the_package_alike(layout: Layout) -> None:
    layout.package("a", cmake="project(b)\nfind_package(catkin)\ncatkin_package()")
    assert layout.faults() == [
        "a/CMakeLists.txt, line 1: the project is called 'b', package.xml calls it 'a', and both "
        "have to be the same"
    ]


def test_a_component_that_nobody_knows_is_a_fault(layout: Layout) -> None:
    layout.package("a", "std_msg", "qwertz")
    assert layout.faults() == [
        "a/CMakeLists.txt, line 3: find_package(): there is no package std_msg here; "
        "did you mean std_msgs?",
        "a/CMakeLists.txt, line 3: find_package(): there is no package qwertz here",
    ]


def test_a_component_is_named_in_the_manifest_too(layout: Layout) -> None:
    layout.package(
        "a",
        manifest=manifest_of("a"),
        cmake="project(a)\nfind_package(catkin REQUIRED COMPONENTS rospy)\ncatkin_package()",
    )
    assert layout.warnings() == [
        "a/CMakeLists.txt, line 2: package.xml lacks <build_depend>rospy</build_depend>"
    ]


def test_catkin_depends_stand_in_the_manifest(layout: Layout) -> None:
    cmake = "project(a)\nfind_package(catkin REQUIRED COMPONENTS rospy)\n"
    layout.package("a", cmake=f"{cmake}catkin_package(CATKIN_DEPENDS rospy)")
    lacks = "catkin_package() depends on rospy, and package.xml lacks"
    assert layout.faults() == [
        f"a/CMakeLists.txt, line 3: {lacks} <build_depend>rospy</build_depend>",
        f"a/CMakeLists.txt, line 3: {lacks} <exec_depend>rospy</exec_depend>",
    ]


def test_the_build_tool_is_named(layout: Layout) -> None:
    text = manifest_of("a").replace("<buildtool_depend>catkin</buildtool_depend>", "")
    layout.package("a", manifest=text)
    assert layout.faults() == [
        "a/package.xml, line 3: <buildtool_depend>catkin</buildtool_depend> is missing"
    ]


def test_a_package_of_ros_2_is_told_apart(layout: Layout) -> None:
    layout.package("a", manifest="<export><build_type>ament_python</build_type></export>")
    (fault,) = layout.faults()
    assert "this is a package of ROS 2 (ament_python)" in fault


def test_messages_need_their_tools(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "std_msgs/String text"}, "std_msgs")
    (path / "package.xml").write_text(manifest_of("a"))
    assert layout.warnings() == [
        "a/CMakeLists.txt, line 3: package.xml lacks "
        "<build_depend>message_generation</build_depend>",
        "a/CMakeLists.txt, line 3: package.xml lacks <build_depend>message_runtime</build_depend>",
        "a/CMakeLists.txt, line 3: package.xml lacks <build_depend>std_msgs</build_depend>",
        "a/CMakeLists.txt, line 5: package.xml lacks <exec_depend>message_runtime</exec_depend>",
        "a/CMakeLists.txt, line 5: package.xml lacks <exec_depend>std_msgs</exec_depend>",
    ]


def test_the_packages_of_types_are_found_before(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "std_msgs/String text"}, "std_msgs")
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("message_runtime std_msgs", "message_runtime"))
    (fault,) = layout.faults()
    assert fault.startswith("a/CMakeLists.txt, line 5: generate_messages() depends on std_msgs")


def test_a_misspelt_dependency_is_warned_of_but_not_one_of_the_system(layout: Layout) -> None:
    depends = "<depend>geometry_msg</depend><depend>python3-numpy</depend><depend>rviz</depend>"
    layout.package("a", manifest=depends)
    assert layout.warnings() == [
        "a/package.xml, line 9: there is no package geometry_msg here; did you mean geometry_msgs?"
    ]


@needs_bit
def test_a_program_without_its_executable_bit_is_warned_of(layout: Layout) -> None:
    layout.package(
        "a",
        after=f"catkin_install_python(PROGRAMS src/node.py DESTINATION {BIN})",
        files={"src/node.py": PROGRAM, "src/other.py": PROGRAM, "src/module.py": "x = 1\n"},
    )
    node, other = layout.warnings()
    assert node.startswith("a/CMakeLists.txt, line 6: node.py is not executable: chmod +x ")
    assert other.startswith(
        "a/src/other.py is not executable, so rosrun will not find it: chmod +x"
    )
    assert "lib/a/node.py" in layout.built()


def test_a_program_without_its_first_line_is_warned_of(layout: Layout) -> None:
    layout.package(
        "a",
        after=f"catkin_install_python(PROGRAMS node.py DESTINATION {BIN})",
        programs={"node.py": "print()\n"},
    )
    (warning,) = layout.warnings()
    assert warning.endswith("its first line should be #!/usr/bin/env python3")


def test_two_programs_of_one_name_are_warned_of(layout: Layout) -> None:
    installed = "\n".join(
        f"catkin_install_python(PROGRAMS {files} DESTINATION {BIN})"
        for files in ("old/node.py old/node.py", "src/node.py")
    )
    programs = {"old/node.py": PROGRAM, "src/node.py": PROGRAM}
    folder = layout.package("a", after=installed, programs=programs)
    assert layout.warnings() == [
        "a/CMakeLists.txt, line 7: a/src/node.py replaces a/old/node.py: both become lib/a/node.py"
    ]
    relay = (layout.devel / "lib" / "a" / "node.py").read_text()
    assert str(folder / "src" / "node.py") in relay


@needs_bit
def test_a_first_line_that_ends_as_on_windows_is_warned_of(layout: Layout) -> None:
    crlf = PROGRAM.replace("\n", "\r\n")
    folder = layout.package("a", programs={"node.py": "", "unix.py": PROGRAM})
    (folder / "node.py").write_bytes(crlf.encode())
    assert layout.warnings() == [
        "a/node.py, line 1: its lines end as on Windows, so it does not run by itself: "
        "save it with LF, not CRLF"
    ]


def test_what_is_in_cpp_is_passed_over_and_told(layout: Layout) -> None:
    layout.package("a", "roscpp", after="add_executable(node src/node.cpp)\nadd_library(lib x.cpp)")
    assert layout.warnings() == [
        "a/CMakeLists.txt, line 6: C++ is not built here: node was passed over",
        "a/CMakeLists.txt, line 7: C++ is not built here: lib was passed over",
    ]


def test_a_package_that_says_nothing_of_itself_is_warned_of(layout: Layout) -> None:
    layout.package("a", cmake="project(a)")
    assert layout.warnings() == ["a/CMakeLists.txt, line 1: catkin_package() is missing"]


def test_a_name_is_known_for_one_reason_alone() -> None:
    assert not PROVIDED & ELSEWHERE
    assert all(name == name.lower() for name in MODULES)
