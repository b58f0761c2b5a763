"""The recipe in a CMakeLists.txt."""

from __future__ import annotations

import pytest

from fibws.ros1.workspace.reader import read_recipe
from fibws.ros1.workspace.recipe import Recipe

from .conftest import BIN, Layout

FIND = "project(a)\nfind_package(catkin REQUIRED COMPONENTS rospy message_generation)\n"


def recipe(layout: Layout, text: str, *files: str) -> Recipe:
    named = {name: "#!/usr/bin/env python3\n" for name in files}
    return read_recipe(layout.package("a", cmake=text, files=named))


def faults(layout: Layout, text: str, *files: str) -> list[str]:
    return [layout.relative(str(fault)) for fault in recipe(layout, text, *files).faults]


def test_a_recipe_says_what_is_to_be_made(layout: Layout) -> None:
    text = f"""\
{FIND}find_package(Boost REQUIRED COMPONENTS system)
add_message_files(FILES Num.msg Other.msg)
add_service_files(
  FILES
  Add.srv
)
generate_messages(DEPENDENCIES std_msgs)
catkin_package(CATKIN_DEPENDS rospy)
catkin_install_python(PROGRAMS src/node.py
  DESTINATION {BIN})
add_executable(node src/node.cpp)
"""
    found = recipe(layout, text, "msg/Num.msg", "msg/Other.msg", "srv/Add.srv", "src/node.py")
    assert not found.faults and not found.warnings
    assert found.project.text == "a"
    assert found.components == {"catkin": 2, "rospy": 2, "message_generation": 2, "Boost": 3}
    assert found.modules == {"Boost"}
    assert [each.path.name for each in found.definitions["msg"]] == ["Num.msg", "Other.msg"]
    assert [each.line for each in found.definitions["srv"]] == [7]
    assert (found.message_packages, found.generates) == ({"std_msgs": 9}, 9)
    assert (found.catkin_depends, found.declares) == ({"rospy": 10}, 10)
    assert [(each.path.name, each.destination) for each in found.programs] == [("node.py", "lib/a")]
    assert found.compiled == {"node": 13}


def test_without_names_all_files_of_the_folder_are_meant(layout: Layout) -> None:
    text = f"{FIND}add_message_files(DIRECTORY more)\ngenerate_messages()\ncatkin_package()"
    found = recipe(layout, text, "more/B.msg", "more/A.msg")
    assert [each.path.name for each in found.definitions["msg"]] == ["A.msg", "B.msg"]


def test_tests_are_passed_over(layout: Layout) -> None:
    text = f"{FIND}catkin_package()\nif(CATKIN_ENABLE_TESTING)\nfind_package(rostest)\nendif()"
    assert "rostest" not in recipe(layout, text).components


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("find_package(catkin)", r"line 1: project(NAME) is missing, with the name in package.xml"),
        ("project()", "line 1: project() needs the package's name"),
        (
            f"{FIND}catkin_pakage()",
            "line 3: there is no command catkin_pakage(); did you mean catkin_package()?",
        ),
        (f"{FIND}catkin_package(rospy)", "line 3: catkin_package() has no use for rospy: CATKIN_"),
        (
            f"{FIND}catkin_package(INCLUDE_DIRS include)",
            "line 3: catkin_package(): there is no folder include",
        ),
        (
            f"{FIND}catkin_package()\ngenerate_messages()",
            "line 4: generate_messages() stands before catkin_package()",
        ),
        (
            f"{FIND}generate_messages()\ngenerate_messages()",
            "line 4: generate_messages() stands in a package once, and did so in line 3",
        ),
        (
            f"{FIND}generate_messages()\nadd_message_files(FILES A.msg)",
            "line 4: add_message_files() stands before generate_messages(), not behind",
        ),
        (
            f"{FIND}add_message_files(A.msg)\ngenerate_messages()",
            "line 3: add_message_files() has no use for A.msg: FILES stands before names",
        ),
        (
            "project(a)\nfind_package(catkin)\nadd_message_files(FILES A.msg)",
            "line 3: add_message_files() comes from message_generation: find_package(catkin ",
        ),
        (
            f"{FIND}add_service_files(FILES A.srv)",
            "line 3: add_service_files(): there is no folder a/srv",
        ),
        (
            f"{FIND}add_action_files(FILES A.action)",
            "line 3: add_action_files() comes from actionlib_msgs",
        ),
        (
            f"{FIND}catkin_package()\ncatkin_python_setup()",
            "line 4: catkin_python_setup() stands before catkin_package()",
        ),
        (f"{FIND}catkin_python_setup()", "line 3: catkin_python_setup(): there is no setup.py"),
        (
            f"{FIND}catkin_install_python(PROGRAMS src/node.py DESTINATION {BIN})",
            f"line 3: {BIN} is set by catkin_package(), which stands before it",
        ),
        (
            f"{FIND}catkin_package()\ncatkin_install_python(PROGRAMS src/node.py)",
            f"line 4: catkin_install_python() needs DESTINATION {BIN}",
        ),
        (
            f"{FIND}catkin_package()\n"
            "catkin_install_python(PROGRAMS src/node.py\n"
            "  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATON})",
            f"line 4: ${{CATKIN_PACKAGE_BIN_DESTINATON}} is not set; did you mean {BIN}?",
        ),
        (
            f"{FIND}catkin_package()\ncatkin_install_python(src/node.py DESTINATION {BIN})",
            "line 4: catkin_install_python() begins with PROGRAMS",
        ),
        (
            f"{FIND}catkin_package()\ncatkin_install_python(PROGRAMS\n node.py\nDESTINATION {BIN})",
            "line 5: there is no program node.py; did you mean src/node.py?",
        ),
        (
            f"{FIND}catkin_package()\ncatkin_install_python(PROGRAMS src/nod.py DESTINATION {BIN})",
            "line 4: there is no program src/nod.py; did you mean src/node.py?",
        ),
        (
            f"{FIND}catkin_package()\ncatkin_install_python(PROGRAMS src/node.py DESTINATION ../x)",
            "line 4: ../x leads out of the folder that programs are put into",
        ),
        (f"{FIND}message(FATAL_ERROR no more)", "line 3: no more"),
        (f"{FIND}add_executable()", "line 3: add_executable() needs a name"),
    ],
)
def test_what_catkin_would_refuse_is_told_with_its_line(
    layout: Layout, text: str, fault: str
) -> None:
    found = faults(layout, text, "src/node.py", "msg/A.msg")
    assert any(each.startswith(f"a/CMakeLists.txt, {fault}") for each in found), found


def test_what_is_optional_may_be_missing(layout: Layout) -> None:
    text = (
        f"{FIND}catkin_package()\ncatkin_install_python(PROGRAMS x.py DESTINATION {BIN} OPTIONAL)"
    )
    assert not recipe(layout, text).faults


def test_commands_of_others_are_passed_over_and_told(layout: Layout) -> None:
    text = f"{FIND}catkin_package()\nmacro(own)\nendmacro()\nown()\nquux_frobnicate(x)"
    found = recipe(layout, text)
    assert not found.faults
    assert [layout.relative(each) for each in found.warnings] == [
        "a/CMakeLists.txt, line 7: quux_frobnicate() is not known here and was passed over"
    ]


def test_what_install_does_not_find_is_told(layout: Layout) -> None:
    text = f"{FIND}catkin_package()\ninstall(FILES launch/a.launch DESTINATION x)"
    found = recipe(layout, text, "launch/b.launch")
    assert layout.relative(found.warnings[0]) == (
        "a/CMakeLists.txt, line 4: install(): there is no launch/a.launch; "
        "did you mean launch/b.launch?"
    )


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("project(a)\ncatkin_package()", "line 2: catkin_package() comes from catkin: "),
        ("project(a)\nfind_package(Catkin)", "line 2: the package is catkin, in lower case"),
        (f"{FIND}catkin_package()\ncatkin_package()", "line 4: catkin_package() stood in line 3"),
        (
            f"{FIND}add_message_files(FILES A.msg)",
            "line 3: nothing is made of these files: generate_messages() is missing",
        ),
    ],
)
def test_what_catkin_lets_pass_is_warned_of(layout: Layout, text: str, warning: str) -> None:
    found = recipe(layout, text, "msg/A.msg")
    assert not found.faults
    said = [layout.relative(each) for each in found.warnings]
    assert any(each.startswith(f"a/CMakeLists.txt, {warning}") for each in said), said
