"""Replacement of files, and locks."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fibws.files import (
    check_not_written,
    locked,
    make_private,
    open_to_write,
    replace_file,
    replacing,
    reserved,
)

posix = pytest.mark.skipif(sys.platform == "win32", reason="Windows has other permissions")
root = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root may change owners"
)


def test_file_is_replaced_and_nothing_else_is_left(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_file(path, b"old\n")
    replace_file(path, b"new\n")
    assert path.read_bytes() == b"new\n"
    assert list(tmp_path.iterdir()) == [path]


def test_reader_of_the_old_file_is_not_disturbed(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_file(path, b"old")
    with path.open("rb") as reader:
        replace_file(path, b"new")
        assert reader.read() == b"old"


def test_failure_leaves_the_folder_unchanged(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError):
        replace_file(tmp_path / "folder", b"text")
    assert [each.name for each in tmp_path.iterdir()] == ["folder"]


@posix
@pytest.mark.parametrize("umask", [0, 0o077])
def test_private_folders_are_so_whatever_the_umask(tmp_path: Path, umask: int) -> None:
    tmp_path.chmod(0o755)
    old = os.umask(umask)
    try:
        make_private(tmp_path / "a" / "b")
        make_private(tmp_path / "a" / "b")
    finally:
        os.umask(old)
    for folder in (tmp_path / "a", tmp_path / "a" / "b"):
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert stat.S_IMODE(tmp_path.stat().st_mode) == 0o755


@posix
def test_permissions_of_a_new_file_are_those_asked_for(tmp_path: Path) -> None:
    replace_file(tmp_path / "secret", b"", 0o600)
    assert stat.S_IMODE((tmp_path / "secret").stat().st_mode) == 0o600


@posix
@pytest.mark.parametrize("mode", [0o640, 0o664, 0o400])
def test_permissions_of_an_existing_file_are_kept(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "file"
    path.touch()
    path.chmod(mode)
    replace_file(path, b"new", 0o600, keep=True)
    assert stat.S_IMODE(path.stat().st_mode) == mode


@posix
@root
def test_owner_of_an_existing_file_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.touch()
    os.chown(path, 1234, 2345)
    replace_file(path, b"new", keep=True)
    assert (path.stat().st_uid, path.stat().st_gid) == (1234, 2345)


@posix
def test_file_whose_owner_cannot_be_kept_is_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    found = path.stat()

    def stat_of_another(path: Path) -> os.stat_result:
        fields = list(os.stat(path))
        fields[stat.ST_UID] = found.st_uid + (path.name == "file")
        return os.stat_result(fields)

    def refuse(*arguments: object) -> None:
        raise PermissionError

    monkeypatch.setattr(Path, "stat", stat_of_another)
    monkeypatch.setattr(Path, "exists", lambda path: True)
    monkeypatch.setattr(os, "chown", refuse)
    with pytest.raises(PermissionError, match="another user"):
        replace_file(path, b"new", keep=True)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@posix
def test_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    link, target = tmp_path / "file", tmp_path / "real" / "target"
    link.symlink_to(target)
    replace_file(link, b"first", keep=True)
    replace_file(link, b"second", keep=True)
    assert link.is_symlink()
    assert target.read_bytes() == b"second"


def test_large_file_is_replaced_after_the_block(tmp_path: Path) -> None:
    path, backup = tmp_path / "it.bag", tmp_path / "it.orig.bag"
    path.write_bytes(b"old")
    path.chmod(0o640)
    backup.write_bytes(b"older")
    with replacing(path, backup=backup) as new:
        assert (new.parent, new.suffix) == (tmp_path, ".bag")
        new.write_bytes(b"new")
        assert path.read_bytes() == b"old"
    assert (path.read_bytes(), backup.read_bytes()) == (b"new", b"old")
    assert sys.platform == "win32" or stat.S_IMODE(path.stat().st_mode) == 0o640
    assert sorted(tmp_path.iterdir()) == [path, backup]


def test_block_that_fails_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "it.bag"
    path.write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt), replacing(path, backup=tmp_path / "copy") as new:
        new.write_bytes(b"new")
        raise KeyboardInterrupt
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_error_has_the_name_that_was_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FileNotFoundError) as found, replacing(Path("none/it.bag")) as new:
        new.write_bytes(b"new")
    assert found.value.filename == str(Path("none/it.bag"))


def test_backup_where_files_have_no_second_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_links(*paths: Path) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "link", no_links)
    path, backup = tmp_path / "it.bag", tmp_path / "it.orig.bag"
    path.write_bytes(b"old")
    with replacing(path, backup=backup) as new:
        new.write_bytes(b"new")
    assert (path.read_bytes(), backup.read_bytes()) == (b"new", b"old")


def test_lock_is_held_by_one_at_a_time(tmp_path: Path) -> None:
    counter = tmp_path / "file"
    counter.write_text("0")

    def count() -> None:
        for _ in range(50):
            with locked(counter):
                number = int(counter.read_text())
                counter.write_text(str(number + 1))

    with ThreadPoolExecutor(4) as threads:
        for each in [threads.submit(count) for _ in range(4)]:
            each.result()
    assert counter.read_text() == "200"


def test_file_is_used_by_one_at_a_time(tmp_path: Path) -> None:
    path = tmp_path / "state"
    with reserved(path):
        replace_file(path, b"new")
        with pytest.raises(BlockingIOError):
            with reserved(path):
                pass
        with reserved(tmp_path / "other"):
            pass
    with reserved(path):
        pass


@posix
def test_file_of_a_killed_program_is_free(tmp_path: Path) -> None:
    path = tmp_path / "state"
    program = (
        "import sys, time; from pathlib import Path; from fibws.files import reserved\n"
        "with reserved(Path(sys.argv[1])): print(flush=True); time.sleep(600)"
    )
    command = [sys.executable, "-c", program, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stdout.readline()
        with pytest.raises(BlockingIOError):
            with reserved(path):
                pass
        process.kill()
        process.wait()
        with reserved(path):
            pass


@posix
@pytest.mark.parametrize("renamed", [False, True])
def test_file_that_is_written_cannot_be_replaced_or_written_by_others(
    tmp_path: Path, *, renamed: bool
) -> None:
    path = tmp_path / "a"
    with open_to_write(path) as file:
        file.write(b"old")
        if renamed:
            path = path.rename(tmp_path / "b")
        with pytest.raises(BlockingIOError, match="being written by ") as found:
            open_to_write(path)
        assert found.value.filename == str(path)
        if Path("/proc/locks").exists():
            assert f"process {os.getpid()} (" in str(found.value)
        with pytest.raises(BlockingIOError), replacing(path):
            raise AssertionError
        assert path.read_bytes() == b"old"
    check_not_written(path)
    check_not_written(tmp_path / "missing")
    with open_to_write(path) as file:
        assert file.read() == b""


def test_file_that_another_program_begins_to_write_meanwhile_is_not_replaced(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"old")
    with pytest.raises(BlockingIOError), replacing(path) as new:
        new.write_bytes(b"new")
        file = open_to_write(path, truncate=False)
    file.close()
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_file_of_a_killed_writer_is_free(tmp_path: Path) -> None:
    path = tmp_path / "a"
    program = "import sys; from fibws.files import open_to_write; file = open_to_write(sys.argv[1])"
    with subprocess.Popen(
        [sys.executable, "-c", f"{program}; print('ready', flush=True); input()", str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"ready\n"
        with pytest.raises(BlockingIOError):
            check_not_written(path)
        process.kill()
    check_not_written(path)


def test_lock_leaves_no_file(tmp_path: Path) -> None:
    with locked(tmp_path / "file"):
        assert not list(tmp_path.iterdir())
