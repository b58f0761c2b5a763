"""The screen and log files."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.launch.output import LogFile, Screen


def test_each_line_follows_its_process_name() -> None:
    seen: list[tuple[str, bool]] = []
    screen = Screen(lambda line, is_error: seen.append((line, is_error)))
    screen.info("hello", bold=True)
    screen.output("talker-1", "1")
    screen.output("talker-1", "2", is_error=True)
    screen.error("no")
    assert seen == [
        ("hello", False),
        ("[talker-1] 1", False),
        ("[talker-1] 2", True),
        ("no", True),
    ]


def test_each_process_has_its_colour_on_a_terminal() -> None:
    seen: list[str] = []
    screen = Screen(lambda line, is_error: seen.append(line), colours=True)
    for process in ("a-1", "b-2", "a-1"):
        screen.output(process, "x")
    screen.info("bold", bold=True)
    screen.info("plain")
    screen.error("red")
    assert seen[0] == seen[2] == "\x1b[36m[a-1]\x1b[0m x"
    assert seen[1] == "\x1b[33m[b-2]\x1b[0m x"
    assert seen[3:] == ["\x1b[1mbold\x1b[0m", "plain", "\x1b[31mred\x1b[0m"]


# Log files


def test_file_is_created_with_its_first_line(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "folder" / "a.log")
    log.close()
    assert not log.path.parent.exists()
    log.write("grün")
    assert log.path.read_text("utf-8") == "grün\n"
    log.close()
    log.write("again")
    log.close()
    assert log.path.read_text("utf-8") == "grün\nagain\n"


def test_file_that_cannot_be_written_raises(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file"):
        LogFile(tmp_path / "file" / "a.log").write("x")
