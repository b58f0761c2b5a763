"""The names in `rospy`."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module

import pytest
import rospy

from ros1.rospy.programs import PYTHONPATH


@pytest.mark.parametrize("name", rospy.__all__)
def test_public_name_exists(name: str) -> None:
    assert getattr(rospy, name) is not None
    assert name in dir(rospy)


@pytest.mark.parametrize(
    "name", ["client", "core", "exceptions", "msg", "names", "rostime", "service", "topics"]
)
def test_modules_are_attributes(name: str) -> None:
    assert getattr(rospy, name) is import_module(f"rospy.{name}")


@pytest.mark.parametrize("name", ["nothing", "_nothing"])
def test_unknown_name_is_an_error(name: str) -> None:
    with pytest.raises(AttributeError, match=f"module 'rospy' has no attribute '{name}'"):
        getattr(rospy, name)


def test_import_loads_no_slow_modules() -> None:
    text = "import rospy, sys; print([m for m in sys.modules if m.partition('.')[0] in %r])"
    slow = {"asyncio", "pydantic", "pydantic_core", "websockets", "yaml", "numpy", "click", "ssl"}
    loaded = subprocess.run(
        [sys.executable, "-c", text % (slow,)],
        env={"PYTHONPATH": str(PYTHONPATH)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert loaded.stdout == "[]\n"
