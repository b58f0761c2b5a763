"""Simulated time: that of the topic /clock, if the parameter /use_sim_time says so."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import genpy

from rospy import core, rostime
from rospy.params import get_param

if TYPE_CHECKING:
    import fibws

CLOCK = "/clock"
USE_SIMTIME = "/use_sim_time"


def begin() -> None:
    """Keep to the graph's simulated time from now on, if it has one: it begins at 0."""
    if not get_param(USE_SIMTIME, False):
        return
    rostime.set_rostime(genpy.Time())
    core.background.begin(_follow(core.background.node))


async def _follow(node: fibws.Node) -> None:
    clock: fibws.Subscription[Any] = node.subscribe(CLOCK, "rosgraph_msgs/Clock", queue_size=1)
    async for message in clock:
        rostime.set_rostime(genpy.Time(message.clock.secs, message.clock.nsecs))
