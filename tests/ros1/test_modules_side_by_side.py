"""What comes with rospy says under fibws what it says under a real ROS, line by line."""

from __future__ import annotations

import pytest
from recorded_answers import Answers

from ros1.side_by_side import SCRIPTS, Part, RealRos, compare
from ros1.side_by_side import ros as ros

SCENARIOS: dict[str, tuple[Part, ...]] = {
    "goals, one at a time": (
        Part("actions/server.py", until="ready", hears=("preempted", 4)),
        Part("actions/client.py", interrupted=False),
    ),
    "goals by their handles": (
        Part("actions/handles_server.py", until="ready", hears=("cancel ", 4)),
        Part("actions/handles_client.py", interrupted=False),
    ),
    "goals in callbacks": (
        Part("actions/polling_server.py", until="ready", hears=("accepted", 4)),
        Part("actions/polling_client.py", interrupted=False),
    ),
    "filters": (Part("filters/fed.py", interrupted=False),),
    "messages of two topics": (Part("filters/synchronized.py", interrupted=False),),
    "the modules of tools": (Part("tools/tools.py", interrupted=False),),
    "bags": (Part("bags/bags.py", interrupted=False),),
    "images": (Part("tools/images.py", interrupted=False),),
    "checks of a device": (Part("tools/diagnostics.py", errors=False, interrupted=False),),
    "markers that people move": (Part("tools/markers.py", errors=False, interrupted=False),),
    "internal modules": (Part("tools/internals.py", interrupted=False),),
    "nodes to launch": (Part("tools/launching.py", interrupted=False),),
    "parameters that others change": (
        Part("reconfigure/server.py", until="ready", errors=False),
        Part("reconfigure/client.py", interrupted=False),
    ),
    "a buffer of transforms": (Part("tf/buffer.py", errors=False, interrupted=False),),
    "a listener to transforms": (
        Part("tf/robot.py", until="ready"),
        Part("tf/observer.py", interrupted=False),
    ),
    "transforms of numpy's numbers": (Part("tf/floats.py", interrupted=False),),
    "a transform that never comes": (Part("tf/waiting.py", until="ready"),),
    "a server of transforms": (
        Part("tf/robot.py", until="ready"),
        Part("tf/lookup_server.py", until="ready", errors=False),
        Part("tf/lookup_client.py", interrupted=False),
    ),
}
NOT_IN_ROS = {"actions/fibonacci_client.py", "actions/fibonacci_server.py"}
"""Debian has no actionlib_tutorials."""


@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", SCENARIOS)
async def test_scenario_goes_as_in_ros(answers: Answers, ros: RealRos, name: str) -> None:
    await compare(answers, ros, *SCENARIOS[name])


@pytest.mark.parametrize("folder", ["actions", "bags", "filters", "reconfigure", "tf", "tools"])
def test_all_scripts_are_played(folder: str) -> None:
    played = {part.script for parts in SCENARIOS.values() for part in parts} | NOT_IN_ROS
    scripts = {path.relative_to(SCRIPTS).as_posix() for path in (SCRIPTS / folder).glob("*.py")}
    assert scripts <= played
