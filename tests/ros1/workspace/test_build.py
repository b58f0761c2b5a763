"""catkin_make as a whole."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from fibws.interfaces import Interfaces
from fibws.ros1.errors import WorkspaceError
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


def test_devel_has_the_files_of_packages(layout: Layout) -> None:
    layout.messages("msgs", {"Num.msg": "int64 num"})
    node(layout, "nodes", "src/talker.py", "msgs")
    plan = layout.plan()
    assert not plan.errors
    assert [package.name for package in plan.built] == ["msgs", "nodes"]
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


def test_building_again_changes_nothing(layout: Layout) -> None:
    layout.messages("msgs", {"Num.msg": "int64 num"})
    layout.plan()
    times = {path: path.stat().st_mtime_ns for path in layout.devel.rglob("*.msg")}
    first = snapshot(layout.devel)
    layout.plan()
    assert snapshot(layout.devel) == first
    assert {path: path.stat().st_mtime_ns for path in times} == times


def test_files_of_removed_packages_are_removed(layout: Layout) -> None:
    folder = node(layout, "a", "src/talker.py")
    layout.messages("b", {"Num.msg": "int64 num"})
    layout.plan()
    mine = layout.devel / "share" / "mine"
    mine.write_text("of the user")
    (folder / "CATKIN_IGNORE").touch()
    layout.plan()
    assert layout.built() == {"share/b/msg/Num.msg", "share/b/package.xml", "share/mine"}
    assert not (layout.devel / "lib").exists()


def test_error_stops_its_package_and_those_that_need_it(layout: Layout) -> None:
    layout.messages("broken", {"Num.msg": "int64 num\nint64 num"})
    layout.messages("needs_it", {"Pair.msg": "broken/Num first"}, "broken")
    node(layout, "runs_it", "src/talker.py", "needs_it")
    node(layout, "other", "src/listener.py")
    plan = layout.plan()
    assert [layout.relative(str(error))[:27] for error in plan.errors] == [
        "broken/msg/Num.msg, line 2:"
    ]
    assert plan.failed == {"broken": [], "needs_it": ["broken"], "runs_it": ["needs_it"]}
    assert [package.name for package in plan.built] == ["other"]
    assert layout.built() == {"lib/other/listener.py", "share/other/package.xml"}


def test_failed_package_keeps_what_was_built_before(layout: Layout) -> None:
    folder = layout.messages("a", {"Num.msg": "int64 num"})
    layout.plan()
    before = snapshot(layout.devel / "share" / "a")
    node(layout, "b", "src/talker.py")
    (folder / "msg" / "Num.msg").write_text("int64 num num")
    assert layout.plan().failed == {"a": []}
    (folder / "package.xml").write_text("<package><name>a</name>")
    assert layout.plan().failed == {"a": []}
    assert snapshot(layout.devel / "share" / "a") == before
    assert "lib/b/talker.py" in layout.built()


def test_planning_writes_nothing(layout: Layout) -> None:
    layout.package("a")
    plan = Workspace(layout.folder, {}).plan()
    assert list(plan.trees) == ["a"]
    assert not layout.devel.exists()


def test_all_errors_are_reported_at_once(layout: Layout) -> None:
    layout.package("a", manifest="<?xml version='1.0'?><package/>")
    layout.package("b", cmake="project(b")
    layout.messages("c", {"Num.msg": "x"})
    (layout.package("d") / "CMakeLists.txt").unlink()
    plan = layout.plan()
    assert plan.failed.keys() == {"a", "b", "c", "d"}
    assert [layout.relative(str(error)).partition(":")[0] for error in plan.errors] == [
        "a/package.xml, line 1",
        "b/CMakeLists.txt, line 1",
        "c/msg/Num.msg, line 1",
        "d/package.xml, line 1",
    ]


def test_metapackage_needs_no_cmake_lists(layout: Layout) -> None:
    meta = layout.package("all", manifest="<export><metapackage/></export>")
    (meta / "CMakeLists.txt").unlink()
    assert layout.warnings() == []


def test_first_of_two_packages_of_one_name_is_built(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num"})
    layout.package("a", folder="two")
    (warning,) = layout.warnings()
    assert warning.startswith("two is ignored")
    assert "share/a/msg/Num.msg" in layout.built()


def test_circle_of_dependencies_stops_its_packages(layout: Layout) -> None:
    layout.package("a", "b")
    layout.package("b", "a")
    layout.package("c", "a")
    layout.package("d")
    plan = layout.plan()
    (error,) = plan.errors
    assert "a -> b -> a" in str(error)
    assert plan.failed == {"a": [], "b": [], "c": ["a"]}
    assert [package.name for package in plan.built] == ["d"]


def test_two_packages_cannot_generate_one_program(layout: Layout) -> None:
    for name in ("a", "b"):
        layout.package(
            name,
            after="catkin_install_python(PROGRAMS talker.py DESTINATION bin)",
            programs={"talker.py": PROGRAM},
        )
    (error,) = layout.errors()
    assert error.startswith("b/CMakeLists.txt, line 6: ") and "bin/talker.py" in error
    assert "share/a/package.xml" in layout.built()


def test_two_packages_cannot_generate_one_module(layout: Layout) -> None:
    for name in ("a", "b"):
        layout.package(
            name,
            before="catkin_python_setup()",
            files={"setup.py": "setup(packages=['common'])", "common/__init__.py": ""},
        )
    (error,) = layout.errors()
    assert error.startswith("b/CMakeLists.txt, line 4: ") and "common/__init__.py" in error


def test_only_chosen_packages_are_built(layout: Layout) -> None:
    first, second = node(layout, "a", "talker.py"), node(layout, "b", "listener.py", "a")
    layout.plan()
    (first / "package.xml").write_text((first / "package.xml").read_text() + "\n")
    (second / "CMakeLists.txt").write_text("project(b)\nfind_package(catkin)\ncatkin_package()")
    layout.plan("b")
    assert layout.built() == {"lib/a/talker.py", "share/a/package.xml", "share/b/package.xml"}
    assert not (layout.devel / "share/a/package.xml").read_text().endswith("\n\n")


def test_unreadable_file_stops_only_its_package(
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
    assert not layout.plan("a").errors
    assert "lib/a/a.py" in layout.built()
    (error,) = layout.errors()
    assert error.startswith("b/CMakeLists.txt, line 4: b/setup.py: ")


def test_unreadable_package_xml_stops_only_its_package(
    layout: Layout, monkeypatch: pytest.MonkeyPatch
) -> None:
    node(layout, "a", "a.py")
    manifest = layout.package("b") / "package.xml"
    read_bytes = Path.read_bytes

    def read(path: Path) -> bytes:
        if path == manifest:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return read_bytes(path)

    monkeypatch.setattr(Path, "read_bytes", read)
    plan = layout.plan()
    assert plan.failed == {"b": []} and str(manifest) in str(plan.errors[0])
    assert "lib/a/a.py" in layout.built()


def test_dependencies_of_chosen_packages_are_built_if_asked_for(layout: Layout) -> None:
    layout.package("a")
    layout.package("b", "a")
    layout.package("c")
    assert layout.plan("b").chosen == {"b"}
    assert layout.plan("b", with_depends=True).chosen == {"a", "b"}


def test_unknown_package_cannot_be_chosen(layout: Layout) -> None:
    layout.package("talker")
    with pytest.raises(WorkspaceError, match="not found in the workspace: talkr; did you mean tal"):
        layout.plan("talkr")
    plan = layout.plan("talker", "x")
    (warning,) = plan.warnings
    assert warning.endswith(": x")
    assert plan.chosen == {"talker"}


def test_cleaning_keeps_the_files_to_source(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num"})
    layout.plan()
    Workspace(layout.folder, {}).clean()
    assert layout.built() == set()
    assert (layout.devel / "setup.bash").is_file()
    assert (layout.devel / "share").is_dir(), "FIBWS_INTERFACES names it"


@pytest.mark.parametrize("by", ["catkin_make", "catkin build", None])
def test_devel_space_of_another_tool_is_not_changed(layout: Layout, by: str | None) -> None:
    layout.package("a")
    layout.devel.mkdir()
    (layout.devel / "lib.so").touch()
    if by:
        (layout.devel / ".built_by").write_text(by)
    for action in (layout.plan, Workspace(layout.folder, {}).clean):
        with pytest.raises(WorkspaceError, match=f"was previously built by {by or 'another tool'}"):
            action()
    assert (layout.devel / "lib.so").exists()


def test_workspace_builds_on_sourced_workspaces(layout: Layout, tmp_path: Path) -> None:
    below = Layout(tmp_path / "below")
    below.messages("msgs", {"Num.msg": "int64 num"})
    below.plan()
    layout.messages("more", {"Pair.msg": "msgs/Num first"}, "msgs")
    prefixes = os.pathsep.join([str(layout.devel), str(below.devel), str(tmp_path / "none"), ""])
    workspace = Workspace(layout.folder, {"CMAKE_PREFIX_PATH": prefixes})
    plan = workspace.plan()
    assert not plan.errors
    workspace.make(plan)
    assert str(below.devel) in (layout.devel / "setup.bash").read_text()
    assert Workspace(layout.folder, {}).plan().failed == {"more": []}, "msgs is missing"


def test_edited_record_is_ignored(layout: Layout) -> None:
    layout.package("a")
    layout.plan()
    for text in ("", "[]", '{"../../mine": "a"}'):
        (layout.devel / ".fibws").write_text(text)
        assert not layout.plan().errors
