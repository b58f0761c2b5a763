"""Logging to a file in ROS's folder, and lines as nodes print them."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator
from pathlib import Path

import pytest
from rosgraph import roslogging


@pytest.fixture
def environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, str]]:
    monkeypatch.setenv(roslogging.FILE_NAME, "")
    root = logging.getLogger()
    handlers, level = list(root.handlers), root.level
    yield {"ROS_LOG_DIR": str(tmp_path / "log")}
    for handler in set(root.handlers).difference(handlers):
        root.removeHandler(handler)
        handler.close()
    root.setLevel(level)


def test_records_go_into_a_file(environment: dict[str, str], tmp_path: Path) -> None:
    path = roslogging.configure_logging("tool", filename="run/tool.log", env=environment)
    assert path == str(tmp_path / "log" / "run" / "tool.log")
    logging.getLogger("rosout").warning("low battery")
    # The hub, if this process has run one, calls the level WARN.
    assert f"[rosout][{logging.getLevelName(logging.WARNING)}]" in Path(path).read_text()
    assert (tmp_path / "log" / "latest").resolve() == tmp_path / "log" / "run"


def test_file_in_the_place_of_the_folder_is_an_error(
    environment: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "log").write_text("")
    with pytest.raises(roslogging.LoggingException, match="in the way"):
        roslogging.configure_logging("tool", env=environment)


def test_folder_that_cannot_be_made_is_a_warning(
    environment: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log").write_text("")
    assert roslogging.configure_logging("tool", filename="a/b.log", env=environment) is None
    assert "ROS_LOG_DIR" in capsys.readouterr().err


def test_lines_are_those_of_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROSCONSOLE_FORMAT", "${severity}: ${message}")
    out, err = io.StringIO(), io.StringIO()
    handler = roslogging.RosStreamHandler(stdout=out, stderr=err)
    for level in (logging.INFO, logging.ERROR):
        handler.handle(logging.LogRecord("rosout", level, "a.py", 1, "text", None, None))
    assert (out.getvalue(), err.getvalue()) == ("INFO: text\n", "ERROR: text\n")
