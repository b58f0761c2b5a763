"""The folders of a workspace, and catkin_init_workspace."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.errors import WorkspaceError
from fibws.ros1.workspace import paths

from .conftest import Layout


def refused(folder: Path) -> str:
    with pytest.raises(WorkspaceError) as error:
        paths.check_workspace(folder)
    return str(error.value)


def test_folder_with_src_is_a_workspace(layout: Layout) -> None:
    paths.check_workspace(layout.folder)


def test_below_the_root_of_a_workspace_the_error_says_where_it_is(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={"src/node.py": ""})
    paths.initialize(layout.source)
    assert str(layout.source) in refused(layout.source)
    assert refused(layout.source).endswith("cd ..")
    assert refused(folder).endswith("cd ../..")
    assert refused(folder / "src").endswith("cd ../../..")


def test_package_in_a_new_workspace_is_not_a_workspace(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={"src/node.py": ""})
    assert refused(folder).endswith("cd ../..")


def test_src_of_a_new_workspace_is_not_a_workspace(layout: Layout) -> None:
    folder = layout.package("fibonacci", files={"src/node.py": ""})
    assert refused(layout.source).endswith("cd ..")
    assert refused(folder / "src").endswith("cd ../../..")
    (elsewhere := layout.source / "notes").mkdir()
    assert "has no src/" in refused(elsewhere)


def test_other_folders_are_not_workspaces(tmp_path: Path) -> None:
    assert "is not a workspace" in refused(tmp_path) and "mkdir src" in refused(tmp_path)
    assert f"{tmp_path / 'none'} not found" in refused(tmp_path / "none")
    (tmp_path / "package.xml").touch()
    assert f"{tmp_path} is a package" in refused(tmp_path)


def test_path_with_a_separator_is_an_error(tmp_path: Path) -> None:
    layout = Layout(tmp_path / "a:b")
    assert "':'" in refused(layout.folder)


def test_workspace_is_found_once_it_is_initialized(layout: Layout) -> None:
    folder = layout.package("fibonacci")
    assert paths.workspace_around(folder) is None
    paths.initialize(layout.source)
    assert paths.workspace_around(folder) == layout.folder
    assert paths.workspace_around(layout.folder) == layout.folder


def test_initializing_marks_src_and_only_once(layout: Layout) -> None:
    path = paths.initialize(layout.source)
    assert "catkin_init_workspace" in path.read_text()
    path.write_text("mine")
    with pytest.raises(WorkspaceError, match="already exists"):
        paths.initialize(layout.source)
    assert path.read_text() == "mine"
    with pytest.raises(WorkspaceError, match="does not exist"):
        paths.initialize(layout.folder / "none")


def test_workspace_is_built_until_it_is_moved(layout: Layout) -> None:
    assert not paths.is_built(layout.folder)
    layout.plan()
    assert paths.is_built(layout.folder)
    assert not paths.is_built(layout.folder.rename(layout.folder.with_name("moved")))


def test_current_folder_is_named_as_in_the_shell(
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
    assert paths.current_folder() == link
    monkeypatch.setenv("PWD", str(tmp_path))
    assert paths.current_folder() == real
    monkeypatch.setenv("PWD", str(tmp_path / "none"))
    assert paths.current_folder() == real
