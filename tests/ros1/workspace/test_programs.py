"""What is a program, and where."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fibws.ros1.workspace.programs import find_files, has_shebang, is_executable, looks_like_program


def write(path: Path, text: str, mode: int) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(mode)
    return path


@pytest.mark.skipif(os.name == "nt", reason="Windows has no executable bit")
def test_a_program_is_marked_as_one(tmp_path: Path) -> None:
    marked = write(tmp_path / "a.py", "", 0o755)
    idle = write(tmp_path / "b", "#!/usr/bin/env python3\n", 0o644)
    text = write(tmp_path / "c.txt", "", 0o644)
    assert [is_executable(each) for each in (marked, idle, text)] == [True, False, False]
    assert [looks_like_program(each) for each in (marked, idle, text)] == [True, True, False]
    assert has_shebang(idle) and not has_shebang(text) and not has_shebang(tmp_path / "none")
    assert not is_executable(tmp_path)


def test_a_name_may_have_folders_before_it(tmp_path: Path) -> None:
    first = write(tmp_path / "nodes" / "a.py", "", 0o755)
    second = write(tmp_path / "scripts" / "a.py", "", 0o755)
    write(tmp_path / ".git" / "a.py", "", 0o755)
    assert list(find_files(tmp_path, "a.py")) == [first, second]
    assert list(find_files(tmp_path, "scripts/a.py")) == [second]
    assert not list(find_files(tmp_path, "cripts/a.py"))
    assert not list(find_files(tmp_path / "none"))


@pytest.mark.skipif(os.name == "nt", reason="Windows lets few make links")
def test_links_are_followed_to_each_folder_once(tmp_path: Path) -> None:
    shared = write(tmp_path / "shared" / "a.py", "", 0o755)
    package = tmp_path / "package"
    package.mkdir()
    (package / "scripts").symlink_to(shared.parent)
    (shared.parent / "again").symlink_to(package)
    assert list(find_files(package, "a.py")) == [package / "scripts" / "a.py"]
