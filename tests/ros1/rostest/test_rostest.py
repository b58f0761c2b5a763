"""A script of tests with a node, and what it asks the hub."""

from __future__ import annotations

from pathlib import Path

import pytest
import rostest
from running_programs import Program

from fibws.hub.server import HubServer

SCRIPT = """
import sys, unittest
import rospy, rostest

class Talking(unittest.TestCase):
    def test_talking(self):
        publisher = rospy.Publisher("chatter", rospy.Header, queue_size=1)
        for _ in range(1000):
            if rostest.is_publisher("/chatter", "/talking"):
                break
        self.assertTrue(rostest.is_publisher("/chatter", "/talking"))
        self.assertFalse(rostest.is_subscriber("/chatter", "/talking"))
        self.assertFalse(rostest.is_publisher("/nothing", "/talking"))

    def test_failing(self):
        self.assertTrue("good" in sys.argv)

rospy.init_node("talking")
rospy.on_shutdown(lambda: print("hook"))
rostest.rosrun("package", "talking", Talking)
print("after", rospy.is_shutdown())
"""


@pytest.mark.parametrize(
    ("argument", "code", "end"), [("good", 0, ["hook", "after True"]), ("bad", 1, ["hook"])]
)
async def test_node_ends_after_its_tests(
    hub: HubServer, tmp_path: Path, argument: str, code: int, end: list[str]
) -> None:
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    program = await Program.start("fibws.rospy", str(script), argument, FIBWS_HUB=hub.url)
    found, out, err = await program.end()
    assert (found, err) == (code, "")
    assert out.splitlines()[-len(end) :] == end
    assert "[Testcase: test_talking] ... ok" in out


def test_missing_hub_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    with pytest.raises(OSError, match=r"127\.0\.0\.1:1"):
        rostest.is_publisher("/chatter", "/talking")


def test_other_names_are_the_same_functions() -> None:
    assert rostest.unitrun.__module__ == "rosunit.run"
    assert rostest.run is rostest.rosrun
