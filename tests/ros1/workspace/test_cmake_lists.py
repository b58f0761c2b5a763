"""The catkin macros in a CMakeLists.txt."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.cmake_lists import CMakeLists, read_cmake_lists

BIN = "${CATKIN_PACKAGE_BIN_DESTINATION}"
ALL_MESSAGES = ["A.msg", "B.msg"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A package with files of all kinds."""
    for name in ("msg/A.msg", "msg/B.msg", "srv/Add.srv", "action/Go.action", "cfg/A.cfg"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "setup.py").touch()
    (tmp_path / "src").mkdir()
    for name in ("node.py", "node"):
        (tmp_path / "src" / name).write_text("#!/usr/bin/env python3\n")
    (tmp_path / "src" / "run.sh").write_text("#!/bin/sh\n")
    return tmp_path


def read(folder: Path, text: str) -> CMakeLists:
    (folder / "CMakeLists.txt").write_text(text)
    return read_cmake_lists(folder, "pkg")


def messages(folder: Path, text: str) -> list[str]:
    lists = read(folder, f"{text}\ngenerate_messages()")
    assert not lists.errors
    return [file.path.name for file in lists.definitions["msg"]]


def targets(folder: Path, text: str) -> list[str]:
    return [program.target for program in read(folder, text).programs]


def test_all_macros_are_read_with_their_lines(folder: Path) -> None:
    lists = read(
        folder,
        f"""\
cmake_minimum_required(VERSION 3.0.2)
project(pkg)
find_package(catkin REQUIRED COMPONENTS rospy std_msgs)
add_message_files(FILES B.msg)
add_service_files(
  FILES
  Add.srv
)
Add_Action_Files(DIRECTORY action FILES Go.action)
generate_messages(DEPENDENCIES std_msgs actionlib_msgs)
generate_dynamic_reconfigure_options(cfg/A.cfg)
catkin_python_setup()
catkin_package(CATKIN_DEPENDS rospy)
catkin_install_python(PROGRAMS src/node.py
  DESTINATION {BIN})
add_executable(${{PROJECT_NAME}}_node src/node.cpp)
add_library(headers INTERFACE)
""",
    )
    assert not lists.errors and not lists.warnings
    assert lists.project == ("pkg", 2)
    assert lists.components == {"rospy": 3, "std_msgs": 3}
    found = {kind: [(f.path.name, f.line) for f in fs] for kind, fs in lists.definitions.items()}
    assert found == {"msg": [("B.msg", 4)], "srv": [("Add.srv", 7)], "action": [("Go.action", 9)]}
    assert (lists.generates, lists.python_setup) == (10, 12)
    assert lists.message_packages == {"std_msgs": 10, "actionlib_msgs": 10}
    assert [file.path.name for file in lists.reconfigure] == ["A.cfg"]
    assert [(each.path.name, each.target) for each in lists.programs] == [
        ("node.py", "lib/pkg/node.py")
    ]
    assert lists.cpp_targets == {"pkg_node": 16}


@pytest.mark.parametrize(
    "text",
    [
        "add_message_files()",
        "add_message_files(DIRECTORY msg)",
        "set(FILES_OF_MINE A.msg B.msg)\nadd_message_files(FILES ${FILES_OF_MINE})",
        'set(X A.msg)\nlist(APPEND X B.msg CACHE)\nset(X "A.msg;B.msg" CACHE STRING "")\n'
        "add_message_files(FILES ${X})",
        "set(X)\nlist(APPEND X A.msg)\nlist(APPEND X B.msg)\nadd_message_files(FILES ${X})",
        'file(GLOB X RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}/msg" msg/*.msg)\n'
        "add_message_files(FILES ${X})",
        "file(GLOB X ${CMAKE_CURRENT_SOURCE_DIR}/msg/*.msg)\nadd_message_files(FILES ${X})",
        'file(GLOB_RECURSE X CONFIGURE_DEPENDS "msg/[AB].msg")\nadd_message_files(FILES ${X})',
        "foreach(each ${somewhere})\n  add_message_files(FILES ${each})\nendforeach()",
        "macro(all)\n  add_message_files(FILES ${ARGN})\nendmacro()\nall(A.msg)",
        "if(NEVER)\n  add_message_files(FILES A.msg)\nelse()\n  add_message_files(FILES B.msg)\n"
        "endif()",
        "add_message_files(FILES A.msg B.msg A.msg)\nadd_message_files(DIRECTORY ${unknown})",
    ],
)
def test_messages_are_found_however_they_are_listed(folder: Path, text: str) -> None:
    assert messages(folder, text) == ALL_MESSAGES


def test_messages_may_be_in_another_folder(folder: Path) -> None:
    (folder / "ros" / "msg").mkdir(parents=True)
    (folder / "ros" / "msg" / "C.msg").touch()
    assert messages(folder, "add_message_files(DIRECTORY ros/msg)") == ["C.msg"]
    assert messages(folder, "add_message_files(DIRECTORY ros/msg FILES C.msg)") == ["C.msg"]
    assert messages(folder, "add_message_files(FILES)") == []


def test_nested_variables_are_replaced(folder: Path) -> None:
    text = "set(pkg_MESSAGES A.msg)\nadd_message_files(FILES ${${PROJECT_NAME}_MESSAGES})"
    assert messages(folder, text) == ["A.msg"]


def test_order_of_macros_does_not_matter(folder: Path) -> None:
    text = (
        "catkin_package()\ngenerate_messages()\nadd_message_files()\ncatkin_python_setup()\n"
        "add_action_files()\n"
    )
    lists = read(folder, text)
    assert not lists.errors
    assert lists.python_setup and all(lists.definitions[kind] for kind in ("msg", "action"))


def test_comments_and_strings_are_not_macros(folder: Path) -> None:
    text = (
        "# add_message_files(\n#   FILES\n#   None.msg\n# )\n"
        "#[[ add_message_files(FILES None.msg) ]]\n"
        'message(STATUS "add_message_files(FILES None.msg) \\" )" [==[ ) ]==])\n'
        'add_definitions(-DVERSION="\\"1 (0)\\"" -DNAME="b c")\n'
        'string(REGEX REPLACE ".+/(.+)\\\\.msg" "\\\\1" X ${Y})\n'
        "add_message_files(FILES A.msg # B.msg\n)"
    )
    lists = read(folder, text)
    assert [(file.path.name, file.line) for file in lists.definitions["msg"]] == [("A.msg", 9)]


def test_unknown_commands_are_ignored(folder: Path) -> None:
    lists = read(folder, "quux(a b (c OR d))\nif(A AND (B OR C))\nendif()\nwhile(x)\n")
    assert not lists.errors and not lists.warnings


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"install(PROGRAMS src/node.py DESTINATION {BIN})", ["lib/pkg/node.py"]),
        (f"install(PROGRAMS src/node src/run.sh DESTINATION {BIN})", ["lib/pkg/node"]),
        ("install(PROGRAMS src/node.py RENAME talker DESTINATION bin)", ["bin/talker"]),
        ("catkin_install_python(PROGRAMS src/node.py DESTINATION lib/x/)", ["lib/x/node.py"]),
        ("catkin_install_python(PROGRAMS src/node.py DESTINATION ${MINE})", ["lib/pkg/node.py"]),
        ("catkin_install_python(PROGRAMS src/node.py)", ["lib/pkg/node.py"]),
        ("catkin_install_python(PROGRAMS src/node.py DESTINATION ../../x)", []),
        ("catkin_install_python(PROGRAMS src/node.py DESTINATION /opt/x)", []),
        ("catkin_install_python(PROGRAMS ${SCRIPTS} DESTINATION bin)", []),
        ("catkin_install_python(PROGRAMS none.py OPTIONAL DESTINATION bin)", []),
        (
            "file(GLOB S RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} src/*.py)\n"
            "catkin_install_python(PROGRAMS ${S} DESTINATION bin)",
            ["bin/node.py"],
        ),
        ("install(FILES src/node.py DESTINATION bin)", []),
        ("install(TARGETS ${PROJECT_NAME} RUNTIME DESTINATION bin)", []),
    ],
)
def test_python_programs_are_installed(folder: Path, text: str, expected: list[str]) -> None:
    assert targets(folder, text) == expected
    assert not read(folder, text).errors


def test_missing_program_of_install_is_a_warning(folder: Path) -> None:
    lists = read(folder, "\ninstall(PROGRAMS node.py DESTINATION bin)")
    assert not lists.errors
    (warning,) = lists.warnings
    assert "line 2" in warning and "did you mean src/node.py?" in warning


@pytest.mark.parametrize(
    ("text", "line", "fact"),
    [
        ("\nadd_message_files(A.msg)", 2, "FILES"),
        ("\nadd_service_files(DIRECTORY services)", 2, "services"),
        ("\ngenerate_dynamic_reconfigure_options(\ncfg/B.cfg)", 3, "did you mean cfg/A.cfg?"),
        ("catkin_install_python(PROGRAMS\nsrc/nod.py DESTINATION x)", 2, "src/node.py"),
        ("catkin_install_python(src/node.py DESTINATION x)", 1, "PROGRAMS"),
    ],
)
def test_errors_have_their_line(folder: Path, text: str, line: int, fact: str) -> None:
    (error,) = read(folder, text).errors
    assert f"CMakeLists.txt, line {line}: " in str(error) and fact in str(error)


def test_missing_setup_py_is_an_error(folder: Path) -> None:
    (folder / "setup.py").unlink()
    lists = read(folder, "catkin_python_setup()")
    assert lists.python_setup is None
    assert "setup.py not found" in str(lists.errors[0])


@pytest.mark.parametrize(
    ("text", "line", "fact"),
    [
        ("project(\n", 1, "missing ')' of project()"),
        ("project(a)\nset(A\nfind_package(catkin)\n", 2, "set()"),
        ("# add_message_files(\n  FILES\n  A.msg\n)\n", 4, "unmatched ')'"),
        ('set(A\n"x)', 2, "unterminated string or comment"),
        ("set(A)\n#[[ x", 2, "unterminated string or comment"),
        ("set(A [=[x)", 1, "unterminated string or comment"),
    ],
)
def test_broken_syntax_is_an_error(folder: Path, text: str, line: int, fact: str) -> None:
    with pytest.raises(PackageFileError) as error:
        read(folder, text)
    assert error.value.line == line
    assert fact in str(error.value)


def test_messages_without_generate_messages_are_warned_of(folder: Path) -> None:
    (warning,) = read(folder, "\nadd_message_files(FILES A.msg)").warnings
    assert "line 2" in warning and "generate_messages()" in warning


@pytest.mark.parametrize(
    "text",
    [
        "\n".join(f"set(A ${{A}}${{A}}{number})" for number in range(200)),
        "set(A ${A})\nadd_message_files(FILES ${A})",
        "set(A " + "[=[x]=]" * 20000 + ")",
        "#" * 100000 + "(" * 100000 + ")" * 100000,
        "file(GLOB A **x /etc/* ../*)",
    ],
)
def test_strange_files_are_read_quickly(folder: Path, text: str) -> None:
    begin = time.process_time()
    read(folder, text)
    assert time.process_time() - begin < 5


def test_tests_are_listed(folder: Path) -> None:
    lists = read(
        folder,
        """
if(CATKIN_ENABLE_TESTING)
  find_package(rostest REQUIRED)
  add_rostest(test/a.test)
  add_rostest(${PROJECT_SOURCE_DIR}/test/b.test DEPENDENCIES x ARGS a:=1 b:=2)
  foreach(T c.test d.test)
    add_rostest(test/${T})
  endforeach()
  catkin_add_nosetests(test TIMEOUT 60)
  roslaunch_add_file_check(launch a=1 USE_TEST_DEPENDENCIES)
  add_rostest_gtest(cpp_test test/c.test test/c.cpp)
endif()
""",
    )
    assert [(each.macro, each.path, each.arguments, each.line) for each in lists.tests] == [
        ("add_rostest", folder / "test/a.test", (), 4),
        ("add_rostest", folder / "test/b.test", ("a:=1", "b:=2"), 5),
        ("catkin_add_nosetests", folder / "test", (), 9),
        ("roslaunch_add_file_check", folder / "launch", ("a:=1",), 10),
    ]
    assert lists.cpp_tests == ["cpp_test"]
    assert not lists.errors and not lists.warnings


def test_testing_is_enabled(folder: Path) -> None:
    text = "set(CFG ${CATKIN_ENABLE_TESTING})\ncatkin_add_nosetests(test/${CFG}.py)"
    assert read(folder, text).tests[0].path.name == "ON.py"
