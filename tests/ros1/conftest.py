"""Makes imports of ROS 1's packages work in these tests."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

import pytest
from genpy import classes

from fibws.interfaces import Interfaces
from fibws.msg import _finder
from fibws.ros1 import finder

Define: TypeAlias = Callable[..., Path]
"""Writes the definition of a type, ``define("fibonacci/Num", "int64 num")``."""

finder.install()


@pytest.fixture
def define(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Define]:
    """Definitions of the test's own, in a folder that is named to this process and its children."""
    folder = tmp_path / "definitions"
    folder.mkdir()
    monkeypatch.setenv("FIBWS_INTERFACES", str(folder))
    monkeypatch.setattr(_finder, "_interfaces", Interfaces())
    before = set(sys.modules)

    def define(type_: str, text: str, kind: str = "msg") -> Path:
        package, _, name = type_.partition("/")
        path = folder / package / kind / f"{name}.{kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
        return path

    yield define
    packages = {path.name for path in folder.iterdir()}
    classes.forget(packages)
    for name in set(sys.modules) - before:
        if name.partition(".")[0] in packages:
            del sys.modules[name]
