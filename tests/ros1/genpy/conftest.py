"""The real genpy, to compare with."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

import pytest
from genpy.classes import message_class

from fibws.msg import default_interfaces

from .world import World

HERE = Path(__file__).parent
PYTHON = "/usr/bin/python3"
OURS = World(message_class)
ADDED = re.compile(
    r" by zero$| and no __dict__ for setting new attributes$|(?<=')[\w.]+\.(?=\w+' object)"
)
"""What Python's own errors say since 3.13; Debian's Python may be an older one, or ours."""

PART = re.compile(r"^MSG: (\S+)$", re.MULTILINE)

Agree: TypeAlias = Callable[..., str]
"""Has both evaluate an expression and asserts that they say the same, which is returned.

Types that it names besides ``std_msgs/Int32`` are to be given: ``agree("M('a/B')", "a/B")``.
"""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "agree" in getattr(item, "fixturenames", ()) and item.path.parent == HERE:
            item.add_marker(pytest.mark.real_ros)


@pytest.fixture(scope="session")
def agree() -> Iterator[Agree]:
    """The real genpy beside ours."""
    if (
        shutil.which(PYTHON) is None
        or subprocess.run(
            [PYTHON, "-I", "-c", "import genpy.dynamic"], capture_output=True
        ).returncode
    ):
        pytest.skip("Debian's python3-genpy is not installed")
    with tempfile.TemporaryDirectory() as home:
        process = subprocess.Popen(
            [PYTHON, "-I", HERE / "world.py"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={"PATH": "/usr/bin:/bin", "HOME": home, "TMPDIR": home, "LANG": "C.UTF-8"},
        )
        assert process.stdin is not None and process.stdout is not None
        stdin, stdout = process.stdin, process.stdout
        defined: set[str] = set()

        def agree(expression: str, *types: str) -> str:
            for type_ in types:
                if type_ not in defined:
                    text = default_interfaces().full_text(type_)
                    stdin.write(f"{json.dumps(['define', type_, text])}\n")
                    defined.update([type_, *PART.findall(text)])
            stdin.write(f"{json.dumps(['say', expression])}\n")
            stdin.flush()
            line = stdout.readline()
            assert line, "the real genpy has ended"
            theirs = ADDED.sub("", json.loads(line))
            ours = ADDED.sub("", OURS.say(expression))
            assert ours == theirs, expression
            return ours

        yield agree
        stdin.close()
        process.wait(60)
        stdout.close()
