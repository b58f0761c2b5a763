"""Logging for programs that are not nodes: to a file in ROS's folder, and lines as nodes print."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

import rospkg
from rospy.console import line_of, log_file

from fibws.node.log import FORMAT, RESET, colour

__all__ = ["LoggingException", "RosStreamHandler", "configure_logging", "renew_latest_logdir"]

FILE_NAME = "ROS_LOG_FILENAME"
LEVEL = logging.INFO


class LoggingException(Exception):
    """Log files cannot be written there."""


def configure_logging(
    logname: str,
    level: int = logging.INFO,
    filename: str | None = None,
    env: Mapping[str, str] | None = None,
) -> str | None:
    """Log to a file in $ROS_LOG_DIR; return its path, or None if the folder cannot be made.

    Args:
        logname: the name of the program, for the file.
        level: has no effect, as in ROS.
        filename: the file's name, which may be in a folder; by default that and the process's id.
        env: environment variables instead of this process's.

    Raises:
        LoggingException: a file has the folder's name.
    """
    folder = Path(rospkg.get_log_dir(env=dict(os.environ if env is None else env)))
    path = folder / (filename or f"{logname or 'unknown'}-{os.getpid()}.log")
    if path.parent.is_file():
        raise LoggingException(f"Cannot save log files: file [{path.parent}] is in the way")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError:
        sys.stderr.write(
            f"WARNING: cannot create log directory [{path.parent}]. "
            "Please set ROS_LOG_DIR to a writable location.\n"
        )
        return None
    if path.parent != folder:
        renew_latest_logdir(str(path.parent))
    os.environ[FILE_NAME] = str(path)
    root = logging.getLogger()
    root.addHandler(log_file(str(path)))
    root.setLevel(LEVEL)
    return str(path)


def renew_latest_logdir(logfile_dir: str) -> bool:
    """Let the link ``latest`` beside a folder lead to it; return whether it does."""
    latest = Path(logfile_dir).parent / "latest"
    try:
        if latest.is_symlink():
            latest.unlink()
        latest.symlink_to(logfile_dir)
    except OSError:
        return False
    return True


class RosStreamHandler(logging.Handler):
    """Prints records as nodes do: in the format of $ROSCONSOLE_FORMAT, warnings on stderr.

    Args:
        colorize: use colours on terminals.
        stdout: where lines below warnings are written.
        stderr: where others are.
    """

    def __init__(
        self, colorize: bool = True, stdout: TextIO | None = None, stderr: TextIO | None = None
    ) -> None:
        super().__init__()
        self._colorize = colorize
        self._stdout = stdout or sys.stdout
        self._stderr = stderr or sys.stderr

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record's line."""
        stream = self._stderr if record.levelno >= logging.WARNING else self._stdout
        line = line_of(record, os.environ.get("ROSCONSOLE_FORMAT", FORMAT))
        if self._colorize and (start := colour(record.levelno, stream)):
            line = f"{start}{line}{RESET}"
        stream.write(f"{line}\n")
