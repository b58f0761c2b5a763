"""The master of an installed ROS, as roscore starts it, for recording what a real ROS does."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from patience import PATIENCE

PYTHON = "/usr/bin/python3"
"""Debian's, which its ROS packages are installed for."""
MASTER = """
import sys, rosgraph, rosmaster.master
master = rosmaster.master.Master(0)
master.start()
while master.uri is None:
    pass
for name in ("/rosdistro", "/rosversion", "/run_id"):
    rosgraph.Master("/roslaunch", master.uri).setParam(name, "any")
print(master.uri, flush=True)
sys.stdin.read()
master.stop()
"""
"""It binds a free port; roscore must be given one, which another program may take first."""
ROSOUT = "/usr/lib/rosout/rosout"


@contextmanager
def roscore(folder: Path) -> Iterator[dict[str, str]]:
    """Run a master and rosout; give the environment of programs that use them.

    Args:
        folder: their home.
    """
    folder.mkdir(exist_ok=True)
    environment = {
        "PATH": "/usr/bin:/bin",
        "HOME": str(folder),
        "ROS_HOME": str(folder / "ros"),
        "ROS_IP": "127.0.0.1",
        "PYTHONPATH": str(folder),
        "LANG": "C.UTF-8",
        "PYTHONUNBUFFERED": "1",
    }
    master = subprocess.Popen(
        [PYTHON, "-c", MASTER],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert master.stdin is not None and master.stdout is not None
    environment["ROS_MASTER_URI"] = master.stdout.readline().strip()
    rosout = subprocess.Popen(
        [ROSOUT], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    listed = ["/usr/bin/rosnode", "list"]
    try:
        while b"/rosout" not in subprocess.run(listed, env=environment, capture_output=True).stdout:
            assert master.poll() is None and rosout.poll() is None, "the master does not start"
        yield environment
    finally:
        rosout.terminate()
        rosout.wait(PATIENCE)
        master.stdin.close()
        master.wait(PATIENCE)
        master.stdout.close()
