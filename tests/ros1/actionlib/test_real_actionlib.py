"""ROS's own actionlib, from its source, on fibws's rospy."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from ros1.side_by_side import SCRIPTS

from .conftest import StartScript

REAL = Path("/usr/lib/python3/dist-packages/actionlib")
RUN = """
import runpy, sys, warnings
warnings.simplefilter("ignore")  # It uses setDaemon and notifyAll.
sys.path.insert(0, {folder!r})
import actionlib
assert actionlib.__file__.startswith({folder!r})
runpy.run_path(sys.argv[1], run_name="__main__")
"""


@pytest.mark.real_ros
@pytest.mark.skipif(not REAL.is_dir(), reason="Debian's python3-actionlib is not installed")
async def test_goals_are_executed(start_script: StartScript, tmp_path: Path) -> None:
    shutil.copytree(REAL, tmp_path / "actionlib", ignore=lambda *_: ["msg", "__pycache__"])
    run = tmp_path / "run.py"
    run.write_text(RUN.format(folder=str(tmp_path)))
    server = await start_script(run, str(SCRIPTS / "actions" / "polling_server.py"))
    while "ready" not in (line := await server.line()):
        assert line, "the server has ended"
    client = await start_script(run, str(SCRIPTS / "actions" / "polling_client.py"))
    code, out, err = await client.end()
    assert code == 0, err
    assert "True 3 result: 6" in out
    assert "True 3 result: 7" in out
