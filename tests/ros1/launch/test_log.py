"""The file of what a process prints."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.launch.log import Log


def test_the_file_is_there_from_its_first_line_on(tmp_path: Path) -> None:
    log = Log(tmp_path / "folder" / "a.log")
    log.close()
    assert not log.path.parent.exists()
    log.write("grün")
    assert log.path.read_text("utf-8") == "grün\n"
    log.close()
    log.write("again")
    log.close()
    assert log.path.read_text("utf-8") == "grün\nagain\n"


def test_a_file_that_cannot_be_written_raises(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file"):
        Log(tmp_path / "file" / "a.log").write("x")
