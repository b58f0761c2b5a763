"""What a CMakeLists.txt carries out."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import PackageFileError
from fibws.ros1.workspace.cmake.script import Script
from fibws.ros1.workspace.cmake.syntax import read_commands


def script(folder: Path, text: str) -> Script:
    file = folder / "CMakeLists.txt"
    file.write_text(text)
    return Script(read_commands(file), folder, str(file), {"HERE": folder.as_posix()})


def said(folder: Path, text: str) -> list[list[str]]:
    """The arguments of each ``say()`` that is carried out."""
    return [call.texts for call in script(folder, text).calls() if call.name == "say"]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("set(A x) say(${A} b)", ["x", "b"]),
        ("set(A x y) say(${A})", ["x", "y"]),
        ('set(A x y) say("${A}")', ["x;y"]),
        ("set(A B) set(B x) say(${${A}})", ["x"]),
        ("set(A x) unset(A) say(a${A}b)", ["ab"]),
        ("set(A x) set(A) say(${A})", []),
        ("set(A x CACHE STRING doc) say(${A})", ["x"]),
        ("say($ENV{PATH})", []),
        ("say([[${A}]])", ["${A}"]),
        ("say(a\\;b a\\ b)", ["a;b", "a b"]),
        ("list(APPEND A x y) list(APPEND A z) say(${A})", ["x", "y", "z"]),
        ("set(A x y x) list(REMOVE_DUPLICATES A) list(SORT A) say(${A})", ["x", "y"]),
        ("set(A x y) list(REMOVE_ITEM A x) list(PREPEND A z) say(${A})", ["z", "y"]),
        ("option(A doc ON) say(${A})", ["ON"]),
    ],
)
def test_variables_have_values(tmp_path: Path, text: str, values: list[str]) -> None:
    assert said(tmp_path, text) == [values]


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        ("TRUE", True),
        ("OFF", False),
        ("1", True),
        ("0", False),
        ("UNKNOWN", False),
        ("X", True),
        ("NOT X", False),
        ("X AND UNKNOWN", False),
        ("UNKNOWN OR X", True),
        ("NOT (UNKNOWN OR X)", False),
        ("DEFINED X", True),
        ("DEFINED UNKNOWN", False),
        ('X STREQUAL "yes"', True),
        ('"${X}" STREQUAL "no"', False),
        ("V VERSION_LESS 1.10", True),
        ("V VERSION_GREATER_EQUAL 1.9", True),
        ("2 GREATER 3", False),
        ("X IN_LIST L", True),
        ('X MATCHES "^y"', True),
        ('X MATCHES "("', False),
        ('X MATCHES "(a+)+$"', False),
        (f"{'9' * 5000} GREATER 5", False),
        ("\N{SUPERSCRIPT TWO} GREATER 1", False),
        ("EXISTS ${HERE}", True),
        ("IS_DIRECTORY ${HERE}/none", False),
        (f"EXISTS {'a' * 5000} OR IS_DIRECTORY {'a' * 5000}", False),
        ("TARGET X", False),
        ("COMMAND f", True),
        ("CATKIN_ENABLE_TESTING", False),
        ("X SOMETHING_ELSE Y", False),
    ],
)
def test_a_condition_is_met_or_not(tmp_path: Path, condition: str, holds: bool) -> None:
    begin = "set(X yes) set(V 1.9) set(L no yes) function(f)\nsay(never)\nendfunction()\n"
    text = f"{begin}if({condition})\nsay(yes)\nelse()\nsay(no)\nendif()"
    assert said(tmp_path, text) == [["yes" if holds else "no"]]


def test_the_first_branch_whose_condition_is_met_is_taken(tmp_path: Path) -> None:
    text = """
    if(OFF)
      say(a)
    elseif(ON)
      if(OFF)
        say(b)
      else()
        say(c)
      endif()
    elseif(ON)
      say(d)
    endif()
    """
    assert said(tmp_path, text) == [["c"]]


def test_foreach_goes_through_a_list(tmp_path: Path) -> None:
    text = "set(L x y)\nforeach(i a ${L})\nsay(${i})\nendforeach()"
    assert said(tmp_path, text) == [["a"], ["x"], ["y"]]
    text = "set(L x y)\nforeach(i IN LISTS L ITEMS z)\nsay(${i})\nendforeach()"
    assert said(tmp_path, text) == [["x"], ["y"], ["z"]]


def test_files_are_found_by_their_pattern(tmp_path: Path) -> None:
    (tmp_path / "msg").mkdir()
    for name in ("B.msg", "A.msg", "c.txt"):
        (tmp_path / "msg" / name).touch()
    relative = "file(GLOB A RELATIVE ${HERE}/msg ${HERE}/msg/*.msg) say(${A})"
    assert said(tmp_path, relative) == [["A.msg", "B.msg"]]
    assert said(tmp_path, "file(GLOB A **x /etc/* A) say(${A})") == [[]]
    everywhere = "file(GLOB_RECURSE A *.txt) say(${A})"
    assert said(tmp_path, everywhere) == [
        [f"{tmp_path.as_posix()}/{name}" for name in ("CMakeLists.txt", "msg/c.txt")]
    ]
    assert said(tmp_path, "file(GLOB A /etc/*) say(${A})") == [[]]


def test_nothing_is_carried_out_behind_return(tmp_path: Path) -> None:
    assert said(tmp_path, "say(a)\nif(ON)\nreturn()\nendif()\nsay(b)") == [["a"]]


def test_the_lines_of_values_are_known(tmp_path: Path) -> None:
    call = next(iter(script(tmp_path, "say(\n  a\n  b)").calls()))
    assert (call.line, [value.line for value in call.values]) == (1, [2, 3])


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("if(ON)\nsay()", r"line 1: if\(\) has no endif\(\)"),
        ("say()\nendif()", r"line 2: endif\(\) ends nothing that was begun"),
        ("if(ON)\nforeach(a b)\nendif()", r"line 3: foreach\(\) of line 2 has no endforeach\(\)"),
        ("foreach()\nendforeach()", r"line 1: foreach\(\) needs a variable"),
    ],
)
def test_a_block_that_has_no_end_is_told(tmp_path: Path, text: str, fault: str) -> None:
    with pytest.raises(PackageFileError, match=fault):
        said(tmp_path, text)


def test_conditions_without_an_end_are_not_met(tmp_path: Path) -> None:
    text = f"if({'(' * 5000}ON{')' * 5000})\nsay(x)\nendif()"
    assert said(tmp_path, text) == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("set(a xxxxxxxxxx)\n" + 'set(a "${a}${a}")\n' * 60, "longer than 1000000 characters"),
        ("set(a [[${a}${a}]]) say(x${a})", "longer than 1000000 characters"),
        ("set(a x)\n" + "list(APPEND a ${a})\n" * 60, "longer than 1000000 characters"),
        (
            "".join(f"foreach(v{depth} 1 2 3 4 5 6 7 8 9)\n" for depth in range(15))
            + "endforeach()\n" * 15,
            "more than 20000 commands",
        ),
    ],
    ids=["doubled", "itself", "list", "loops"],
)
def test_what_grows_without_end_is_refused(tmp_path: Path, text: str, fault: str) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(text)
    with pytest.raises(PackageFileError, match=fault):
        list(Script(read_commands(file), tmp_path, str(file), {}).calls())
