"""catkin_make as a whole."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from fibws.errors import WorkspaceError
from fibws.interfaces import Interfaces
from fibws.ros1.workspace.build import Workspace

from .conftest import BIN, Layout

PROGRAM = "#!/usr/bin/env python3\nprint('hello')\n"


def node(layout: Layout, name: str, program: str, *depends: str) -> Path:
    return layout.package(
        name,
        *depends,
        after=f"catkin_install_python(PROGRAMS {program} DESTINATION {BIN})",
        programs={program: PROGRAM},
    )


def snapshot(folder: Path) -> dict[str, bytes]:
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def test_devel_holds_what_packages_are_made_into(layout: Layout) -> None:
    layout.messages("msgs", {"Num.msg": "int64 num"})
    node(layout, "nodes", "src/talker.py", "msgs")
    plan = layout.plan()
    assert not plan.faults
    assert [source.name for source in plan.built] == ["msgs", "nodes"]
    assert layout.built() == {
        "lib/nodes/talker.py",
        "share/msgs/msg/Num.msg",
        "share/msgs/package.xml",
        "share/nodes/package.xml",
    }
    assert (layout.devel / ".catkin").read_text() == str(layout.source)
    assert (layout.folder / ".catkin_workspace").is_file()
    assert (layout.folder / "build" / "CATKIN_IGNORE").is_file()
    interfaces = Interfaces([layout.devel / "share"])
    assert interfaces.messages("msgs") == ["msgs/Num"]


def test_what_is_built_twice_stays_as_it_is(layout: Layout) -> None:
    layout.messages("msgs", {"Num.msg": "int64 num"})
    layout.plan()
    times = {path: path.stat().st_mtime_ns for path in layout.devel.rglob("*.msg")}
    first = snapshot(layout.devel)
    layout.plan()
    assert snapshot(layout.devel) == first
    assert {path: path.stat().st_mtime_ns for path in times} == times


def test_what_is_no_more_is_taken_out(layout: Layout) -> None:
    folder = node(layout, "a", "src/talker.py")
    layout.messages("b", {"Num.msg": "int64 num"})
    layout.plan()
    mine = layout.devel / "share" / "mine"
    mine.write_text("of the user")
    (folder / "CATKIN_IGNORE").touch()
    layout.plan()
    assert layout.built() == {"share/b/msg/Num.msg", "share/b/package.xml", "share/mine"}
    assert not (layout.devel / "lib").exists()


def test_nothing_is_written_if_anything_is_wrong(layout: Layout) -> None:
    folder = layout.messages("a", {"Num.msg": "int64 num"})
    layout.plan()
    before = snapshot(layout.devel)
    node(layout, "b", "src/talker.py")
    (folder / "msg" / "Num.msg").write_text("int64 num num")
    assert len(layout.faults()) == 1
    assert snapshot(layout.devel) == before


def test_a_plan_says_all_before_anything_is_written(layout: Layout) -> None:
    layout.package(
        "a",
        before="catkin_python_setup()",
        files={"setup.py": "setup(scripts=['scripts/a'])"},
    )
    plan = Workspace(layout.folder, {}).plan()
    assert ["scripts are left where they are" in each for each in plan.warnings] == [True]
    assert list(plan.trees) == ["a"]
    assert not layout.devel.exists()


def test_all_that_is_wrong_is_told_at_once(layout: Layout) -> None:
    layout.package("a", manifest="<?xml version='1.0'?><package/>")
    layout.package("b", cmake="project(b")
    layout.package("c", "qwertz")
    (layout.package("d") / "CMakeLists.txt").unlink()
    assert layout.faults() == [
        "a/package.xml, line 1: <name> is missing",
        "b/CMakeLists.txt, line 1: the ) that ends project( is missing",
        "d/package.xml, line 1: there is no CMakeLists.txt beside it",
        "c/CMakeLists.txt, line 3: find_package(): there is no package qwertz here",
    ]


def test_a_metapackage_is_built_of_nothing(layout: Layout) -> None:
    meta = layout.package("all", manifest="<export><metapackage/></export>")
    (meta / "CMakeLists.txt").unlink()
    assert layout.warnings() == []


def test_two_packages_cannot_have_one_name(layout: Layout) -> None:
    layout.package("a", folder="one")
    layout.package("a", folder="two")
    with pytest.raises(WorkspaceError, match="Multiple packages found with the same name 'a': "):
        layout.plan()


def test_packages_cannot_depend_on_each_other_in_a_circle(layout: Layout) -> None:
    layout.package("a", "b")
    layout.package("b", "a")
    with pytest.raises(WorkspaceError, match="in a circle: a -> b -> a"):
        layout.plan()


def test_two_packages_cannot_make_one_program(layout: Layout) -> None:
    for name in ("a", "b"):
        layout.package(
            name,
            after="catkin_install_python(PROGRAMS talker.py DESTINATION bin)",
            programs={"talker.py": PROGRAM},
        )
    assert layout.faults() == ["b/CMakeLists.txt, line 6: a makes bin/talker.py, too"]


def test_two_packages_cannot_make_one_module(layout: Layout) -> None:
    for name in ("a", "b"):
        layout.package(
            name,
            before="catkin_python_setup()",
            files={"setup.py": "setup(packages=['common'])", "common/__init__.py": ""},
        )
    fault = "b/CMakeLists.txt, line 4: a makes lib/python3/dist-packages/common/__init__.py, too"
    assert layout.faults() == [fault]


def test_some_packages_are_built_and_others_stay_as_they_were(layout: Layout) -> None:
    first, second = node(layout, "a", "talker.py"), node(layout, "b", "listener.py", "a")
    layout.plan()
    (first / "package.xml").write_text((first / "package.xml").read_text() + "\n")
    (second / "CMakeLists.txt").write_text("project(b)\nfind_package(catkin)\ncatkin_package()")
    layout.plan("b")
    assert layout.built() == {"lib/a/talker.py", "share/a/package.xml", "share/b/package.xml"}
    assert not (layout.devel / "share/a/package.xml").read_text().endswith("\n\n")


def test_what_cannot_be_read_of_a_package_harms_no_other(
    layout: Layout, monkeypatch: pytest.MonkeyPatch
) -> None:
    node(layout, "a", "a.py")
    setup = layout.package("b", before="catkin_python_setup()", files={"setup.py": ""}) / "setup.py"
    read_text = Path.read_text

    def read(path: Path, *words: Any, **options: Any) -> str:
        if path == setup:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return read_text(path, *words, **options)

    monkeypatch.setattr(Path, "read_text", read)
    assert not layout.plan("a").faults
    assert "lib/a/a.py" in layout.built()
    assert layout.faults() == ["b/CMakeLists.txt, line 4: b/setup.py: Permission denied"]


def test_what_they_depend_on_is_built_with_them_if_asked_for(layout: Layout) -> None:
    layout.package("a")
    layout.package("b", "a")
    layout.package("c")
    assert layout.plan("b").chosen == {"b"}
    assert layout.plan("b", with_depends=True).chosen == {"a", "b"}


def test_a_package_that_is_not_there_cannot_be_built(layout: Layout) -> None:
    layout.package("talker")
    with pytest.raises(WorkspaceError, match="not found in the workspace: talkr; did you mean tal"):
        layout.plan("talkr")
    plan = layout.plan("talker", "x")
    assert plan.warnings == ["Packages not found in the workspace: x"]
    assert plan.chosen == {"talker"}


def test_cleaning_leaves_what_is_to_be_sourced(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num"})
    layout.plan()
    Workspace(layout.folder, {}).clean()
    assert layout.built() == set()
    assert (layout.devel / "setup.bash").is_file()
    assert (layout.devel / "share").is_dir(), "FIBWS_INTERFACES names it"


@pytest.mark.parametrize("by", ["catkin_make", "catkin build", None])
def test_what_another_tool_has_built_is_left_alone(layout: Layout, by: str | None) -> None:
    layout.package("a")
    layout.devel.mkdir()
    (layout.devel / "lib.so").touch()
    if by:
        (layout.devel / ".built_by").write_text(by)
    for action in (layout.plan, Workspace(layout.folder, {}).clean):
        with pytest.raises(WorkspaceError, match=f"was previously built by {by or 'another tool'}"):
            action()
    assert (layout.devel / "lib.so").exists()


def test_a_workspace_builds_on_those_that_were_sourced(layout: Layout, tmp_path: Path) -> None:
    below = Layout(tmp_path / "below")
    below.messages("msgs", {"Num.msg": "int64 num"})
    below.plan()
    layout.messages("more", {"Pair.msg": "msgs/Num first"}, "msgs")
    prefixes = os.pathsep.join([str(layout.devel), str(below.devel), str(tmp_path / "none"), ""])
    workspace = Workspace(layout.folder, {"CMAKE_PREFIX_PATH": prefixes})
    plan = workspace.plan()
    assert not plan.faults
    workspace.make(plan)
    assert str(below.devel) in (layout.devel / "setup.bash").read_text()
    assert len(Workspace(layout.folder, {}).plan().faults) == 2, "alone it lacks msgs"


def test_a_record_that_somebody_broke_is_no_obstacle(layout: Layout) -> None:
    layout.package("a")
    layout.plan()
    for text in ("", "[]", '{"../../mine": "a"}'):
        (layout.devel / ".fibws").write_text(text)
        assert not layout.plan().faults
