"""A workspace's package in a folder."""

from __future__ import annotations

import sys
from pathlib import Path

from fibws.ros1.workspace.packages import Packages

MANIFEST = """<package format="2"><name>{}</name><version>0.0.0</version>
<description>x</description><maintainer email="a@example.com">a</maintainer>
<license>BSD</license></package>"""


def package(folder: Path, name: str = "robot", **files: str) -> Packages:
    """Make a package in ``folder``; a file ``count_py`` is an executable ``scripts/count.py``,
    and ``main_launch`` is ``launch/main.launch``.
    """
    root = folder / name
    root.mkdir(parents=True)
    (root / "package.xml").write_text(MANIFEST.format(name))
    for key, text in files.items():
        stem, _, suffix = key.rpartition("_")
        path = root / ("launch" if suffix == "launch" else "scripts") / f"{stem}.{suffix}"
        path.parent.mkdir(exist_ok=True)
        if suffix == "py":
            text = f"#!{sys.executable}\n{text}"
        path.write_text(text)
        path.chmod(0o644 if suffix == "launch" else 0o755)
    return Packages([folder])
