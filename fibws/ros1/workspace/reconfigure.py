"""Modules of dynamic_reconfigure: made by the .cfg files of packages, which are Python programs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from fibws.ros1.errors import PackageFileError
from fibws.ros1.workspace.file_writer import File, Tree, write
from fibws.ros1.workspace.setup_files import MODULES

TIMEOUT = 20.0
"""Seconds in which a .cfg file must have run."""
MOST_BYTES = 16 * 1024 * 1024
"""Bytes that a module may have."""


def config_modules(package: str, file: Path, importable: Tree) -> Tree:
    """Run a .cfg file; return the module that it writes, and the package around that.

    Args:
        package: the package's name.
        file: the .cfg file.
        importable: the modules of the workspace that it may import.

    Raises:
        PackageFileError: the file fails, takes too long, or writes nothing.
    """
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder, "devel"), importable)
        paths = str(Path(folder, "devel", MODULES)), os.environ.get("PYTHONPATH", "")
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(filter(None, paths)),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        # The arguments are those of dynamic_reconfigure's CMake macro: folders to write to.
        command = [sys.executable, "-P", "-m", "fibws.rospy", str(file), *[folder] * 4]
        try:
            done = subprocess.run(
                command,
                cwd=file.parent,
                env=environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=TIMEOUT,
                check=False,
            )
        except subprocess.TimeoutExpired:
            text = f"it has not ended within {TIMEOUT:g} s"
            raise PackageFileError(str(file), 1, text) from None
        if done.returncode:
            raise _failed(file, done.stderr.decode("utf-8", "replace"), done.returncode)
        written = sorted(Path(folder, "cfg").glob("*Config.py"))
        if not written:
            text = "it writes no module: end with exit(gen.generate(PACKAGE, NODE, NAME))"
            raise PackageFileError(str(file), 1, text)
        modules = {each.name: each.read_bytes() for each in written}
    if sum(map(len, modules.values())) > MOST_BYTES:
        raise PackageFileError(str(file), 1, f"its module is too large (limit {MOST_BYTES} bytes)")
    base = f"{MODULES}/{package}/cfg"
    return {
        f"{base}/__init__.py": File(b""),
        **{f"{base}/{name}": File(data) for name, data in modules.items()},
    }


def _failed(file: Path, printed: str, status: int) -> PackageFileError:
    """Return the error of a .cfg file that has failed, with the line where that was."""
    lines = re.findall(rf'File "{re.escape(str(file))}", line (\d+)', printed)
    last = (printed.strip().splitlines() or [f"it ended with status {status}"])[-1]
    return PackageFileError(str(file), int(lines[-1]) if lines else 1, last)
