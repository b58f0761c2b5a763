"""Where a workspace is, and what catkin_init_workspace does."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import WorkspaceError
from fibws.ros1.workspace import place

from .conftest import Layout


def refused(folder: Path) -> str:
    with pytest.raises(WorkspaceError) as error:
        place.check(folder)
    return str(error.value)


def test_a_folder_with_src_is_a_workspace(layout: Layout) -> None:
    place.check(layout.folder)


def test_within_a_workspace_the_way_up_is_told(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={"src/node.py": ""})
    place.initialize(layout.source)
    root = f"catkin_make is called in the root of the workspace, not in {layout.source}"
    assert refused(layout.source) == f"{root}: cd .."
    assert refused(folder).endswith("cd ../..")
    assert refused(folder / "src").endswith("cd ../../..")


def test_a_package_in_a_workspace_that_was_never_built_is_no_workspace(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={"src/node.py": ""})
    assert refused(folder).endswith("cd ../..")


def test_src_that_was_never_built_is_no_workspace(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={"src/node.py": ""})
    assert refused(layout.source).endswith(f"not in {layout.source}: cd ..")
    assert refused(folder / "src").endswith("cd ../../..")
    (elsewhere := layout.source / "notes").mkdir()
    assert "has no src/" in refused(elsewhere)


def test_what_is_no_workspace_is_told_so(tmp_path: Path) -> None:
    assert refused(tmp_path).endswith(
        "is no workspace, for it has no src/: cd into yours, or begin one: mkdir src"
    )
    assert refused(tmp_path / "none") == f"there is no folder {tmp_path / 'none'}"
    (tmp_path / "package.xml").touch()
    assert "is a package, and catkin_make is called in the root of a workspace" in refused(tmp_path)


def test_a_path_that_no_path_can_hold_is_refused(tmp_path: Path) -> None:
    layout = Layout(tmp_path / "a:b")
    assert refused(layout.folder).startswith("the path of a workspace cannot have : in it")


def test_a_workspace_is_found_from_within_once_catkin_was_there(layout: Layout) -> None:
    folder = layout.package("fibonacci")
    assert place.around(folder) is None
    place.initialize(layout.source)
    assert place.around(folder) == layout.folder
    assert place.around(layout.folder) == layout.folder


def test_initializing_marks_src_and_only_once(layout: Layout) -> None:
    path = place.initialize(layout.source)
    assert "Made by catkin_init_workspace" in path.read_text()
    path.write_text("mine")
    with pytest.raises(WorkspaceError, match="already exists: the workspace is initialized"):
        place.initialize(layout.source)
    assert path.read_text() == "mine"
    with pytest.raises(WorkspaceError, match="does not exist"):
        place.initialize(layout.folder / "none")


def test_a_workspace_is_built_until_it_is_moved(layout: Layout) -> None:
    assert not place.is_built(layout.folder)
    layout.plan()
    assert place.is_built(layout.folder)
    assert not place.is_built(layout.folder.rename(layout.folder.with_name("moved")))


def test_the_folder_is_called_as_the_shell_shows_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, link = tmp_path / "real", tmp_path / "link"
    real.mkdir()
    try:
        link.symlink_to(real)
    except OSError:
        pytest.skip("this system makes no links")
    monkeypatch.chdir(link)
    monkeypatch.setenv("PWD", str(link))
    assert place.here() == link
    monkeypatch.setenv("PWD", str(tmp_path))
    assert place.here() == real
    monkeypatch.setenv("PWD", str(tmp_path / "none"))
    assert place.here() == real
