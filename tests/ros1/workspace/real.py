"""The real catkin_pkg, of Debian's python3-catkin-pkg, where it is installed."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable

import pytest

PYTHON = "/usr/bin/python3"


def _has_catkin_pkg() -> bool:
    if shutil.which(PYTHON) is None or shutil.which("catkin_create_pkg", path="/usr/bin") is None:
        return False
    return not subprocess.run([PYTHON, "-c", "import catkin_pkg"], capture_output=True).returncode


_skip = pytest.mark.skipif(
    not _has_catkin_pkg(), reason="Debian's python3-catkin-pkg is not installed"
)


def needs_catkin_pkg(test: Callable[..., None]) -> Callable[..., None]:
    """Mark a test that compares with the real catkin_pkg."""
    marked: Callable[..., None] = pytest.mark.real_ros(_skip(test))
    return marked
