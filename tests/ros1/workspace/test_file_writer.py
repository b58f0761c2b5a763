"""Writing and removing the files of a folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.ros1.workspace.file_writer import File, remove, write


def test_folders_are_created(tmp_path: Path) -> None:
    write(tmp_path / "devel", {"lib/a/node.py": File(b"x", executable=True), "b": File(b"y")})
    program = tmp_path / "devel" / "lib" / "a" / "node.py"
    assert program.read_bytes() == b"x"
    if os.name != "nt":
        assert os.access(program, os.X_OK) and not os.access(tmp_path / "devel" / "b", os.X_OK)


def test_files_that_do_not_change_are_not_touched(tmp_path: Path) -> None:
    write(tmp_path, {"a": File(b"x"), "b": File(b"x")})
    before = (tmp_path / "a").stat().st_ino
    write(tmp_path, {"a": File(b"x"), "b": File(b"y")})
    assert (tmp_path / "a").stat().st_ino == before
    assert (tmp_path / "b").read_bytes() == b"y"


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_file_becomes_executable(tmp_path: Path) -> None:
    write(tmp_path, {"a": File(b"x")})
    write(tmp_path, {"a": File(b"x", executable=True)})
    assert os.access(tmp_path / "a", os.X_OK)


def test_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, {"a": File(b"old")})

    def fail(*_: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="the disk is full"):
        write(tmp_path, {"a": File(b"new")})
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    assert (tmp_path / "a").read_bytes() == b"old"


def test_empty_folders_are_removed(tmp_path: Path) -> None:
    write(tmp_path, {"a/b/c": File(b""), "a/d": File(b"")})
    remove(tmp_path, ["a/b/c", "none"])
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a", "d"]


def test_nothing_outside_the_folder_is_removed(tmp_path: Path) -> None:
    (tmp_path / "mine").touch()
    inside = tmp_path / "devel"
    inside.mkdir()
    remove(inside, ["../mine", str(tmp_path / "mine")])
    assert (tmp_path / "mine").exists()


def test_folder_in_place_of_a_file_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "a" / "within").mkdir(parents=True)
    with pytest.raises(IsADirectoryError) as error:
        write(tmp_path, {"a": File(b"x")})
    assert error.value.filename == str(tmp_path / "a")


@pytest.mark.skipif(os.name == "nt", reason="Windows lets few make links")
def test_files_behind_links_are_not_removed(tmp_path: Path) -> None:
    other = tmp_path / "other" / "file"
    write(tmp_path / "other", {"file": File(b"x")})
    (tmp_path / "devel").mkdir()
    (tmp_path / "devel" / "lib").symlink_to(other.parent)
    remove(tmp_path / "devel", ["lib/file"])
    assert other.exists()
