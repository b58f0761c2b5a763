"""A package to launch, with programs that do not need rospy."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest
from click.testing import CliRunner, Result

from fibws.cli.commands import command

MANIFEST = """<package format="2"><name>robot</name><version>0.0.0</version>
<description>x</description><maintainer email="a@example.com">a</maintainer>
<license>BSD</license></package>"""

WAITER = f"""#!{sys.executable}
import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
print("waits", *sys.argv[1:], os.environ.get("ROS_NAMESPACE"), flush=True)
signal.pause()
"""
FAILER = f"""#!{sys.executable}
import sys
print("works", flush=True)
sys.exit("does not work")
"""
# Shell scripts, which run directly.
TALKER = "#!/bin/sh\nexec '{python}' -m fibws.broadcaster --rate 1 \"$@\"\n"
LISTENER = "#!/bin/sh\nexec '{python}' -m fibws.listener \"$@\"\n"

LAUNCH = """<launch>
  <arg name="speed" default="2.5" doc="how fast"/>
  <arg name="name"/>
  <param name="speed" value="$(arg speed)"/>
  <rosparam>limits: {low: 1, high: deg(180)}</rosparam>
  <group ns="g">
    <node pkg="robot" type="waiter" name="$(arg name)" args="a 'b c'" output="screen">
      <remap from="x" to="y"/><param name="p" value="1"/>
    </node>
  </group>
</launch>"""


Launch: TypeAlias = Callable[..., Result]


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a package with programs and a launch file, on ROS_PACKAGE_PATH."""
    root = tmp_path / "src" / "robot"
    (root / "scripts").mkdir(parents=True)
    (root / "launch").mkdir()
    (root / "package.xml").write_text(MANIFEST)
    (root / "launch" / "robot.launch").write_text(LAUNCH)
    for name, text in {
        "waiter": WAITER,
        "failer": FAILER,
        "talker": TALKER,
        "listener": LISTENER,
    }.items():
        path = root / "scripts" / name
        path.write_text(text.replace("{python}", sys.executable))
        path.chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    monkeypatch.setenv("ROS_HOME", str(tmp_path / "home"))
    for name in ("ROS_LOG_DIR", "ROS_NAMESPACE", "FIBWS_HUB", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)
    return root


@pytest.fixture
def launch(robot: Path) -> Launch:
    """Run ``fibws launch`` in this process, without a hub."""

    def launch(*words: str, input: str | bytes | None = None) -> Result:
        return CliRunner().invoke(command, ["launch", *words], input=input, prog_name="fibws")

    return launch


def write(robot: Path, text: str) -> str:
    """Write a launch file; return its path."""
    file = robot / "launch" / "test.launch"
    file.write_text(f"<launch>{text}</launch>")
    return str(file)
