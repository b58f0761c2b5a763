"""The command rosbag for scripts that call it as a function."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence

__all__ = ["rosbagmain"]


def rosbagmain(argv: Sequence[str] | None = None) -> None:
    """Run rosbag.

    Args:
        argv: the program's name and its arguments; by default those of this program.

    Raises:
        SystemExit: rosbag failed.
    """
    words = list(sys.argv if argv is None else argv)[1:]
    done = subprocess.run([sys.executable, "-P", "-m", "fibws.cli", "rosbag", *words], check=False)
    if done.returncode:
        sys.exit(done.returncode)
