"""Parameters as rosparam has them, where that is installed."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

import pytest
from hub_in_thread import Run
from running_programs import free_port

pytestmark = [
    pytest.mark.real_ros,
    pytest.mark.skipif(
        shutil.which("rosparam") is None or shutil.which("rosmaster") is None,
        reason="rosparam and rosmaster are not installed (python3-rosparam, python3-rosmaster)",
    ),
]

Rosparam: TypeAlias = Callable[..., str]

FILE = """
gains: {p: 1, i: 0.5, d: "0"}
angle: deg(90)
half: rad(pi/2)
sure: yes
list: [1, two, [3.5, {four: 5}]]
---
_ns: arm
text: "one\\ntwo: 'three'"
empty: ''
"""


@pytest.fixture
def rosparam(tmp_path: Path) -> Iterator[Rosparam]:
    """Runs rosparam with a ROS master of its own, and returns what it prints."""
    port = free_port()
    environment = {
        **os.environ,
        "PYTHONPATH": "",
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_HOSTNAME": "127.0.0.1",
        "ROS_LOG_DIR": str(tmp_path / "log"),
    }
    master = subprocess.Popen(
        ["rosmaster", "--core", "-p", str(port)],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )

    def run(*words: str) -> str:
        ran = subprocess.run(["rosparam", *words], env=environment, capture_output=True, text=True)
        return ran.stdout if ran.returncode == 0 else ran.stderr

    try:
        while run("list").startswith("ERROR"):
            assert master.poll() is None, "the ROS master does not start"
        yield run
    finally:
        master.terminate()
        master.wait()


def test_what_is_loaded_is_listed_got_and_dumped_alike(
    run: Run, rosparam: Rosparam, tmp_path: Path
) -> None:
    (tmp_path / "file.yaml").write_text(FILE)

    def ours(*words: str) -> str:
        return run("param", *words).output

    for both in (ours, rosparam):
        both("delete", "/")
        both("load", str(tmp_path / "file.yaml"), "/robot")
        both("set", "/robot/negative", "-5")
        both("set", "/robot/text", "")
        both("set", "/robot/gains", "{p: 2, more: {x: 1}}")
        both("delete", "/robot/sure")
    for words in (
        ("list",),
        ("list", "/robot/arm"),
        ("get", "/"),
        ("get", "-p", "/"),
        *(("get", name) for name in rosparam("list").split()),
        *(("get", "-p", name) for name in rosparam("list").split()),
    ):
        assert ours(*words) == rosparam(*words), words
    for both, name in ((ours, "ours"), (rosparam, "theirs")):
        both("dump", str(tmp_path / name), "/robot")
    assert (tmp_path / "ours").read_text() == (tmp_path / "theirs").read_text()
