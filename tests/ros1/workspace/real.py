"""The real catkin_pkg, of Debian's python3-catkin-pkg, where it is installed."""

from __future__ import annotations

import shutil
import subprocess

import pytest

PYTHON = "/usr/bin/python3"


def _has_catkin_pkg() -> bool:
    if shutil.which(PYTHON) is None or shutil.which("catkin_create_pkg", path="/usr/bin") is None:
        return False
    return not subprocess.run([PYTHON, "-c", "import catkin_pkg"], capture_output=True).returncode


needs_catkin_pkg = pytest.mark.skipif(
    not _has_catkin_pkg(), reason="there is no real catkin_pkg to compare with"
)
