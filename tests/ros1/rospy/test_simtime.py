"""Simulated time, which a node takes from the graph."""

from __future__ import annotations

import asyncio
from itertools import count

import fibws
from fibws.msg.rosgraph_msgs import Clock
from ros1.rospy.programs import running_hub


async def test_node_uses_simulated_time() -> None:
    async with running_hub() as programs, fibws.Node("clock", hub=programs.hub.url) as node:
        await node.params.set("/use_sim_time", True)
        clock = await node.advertise("/clock", Clock, latch=True)
        program = await programs.start("""
            import rospy
            rospy.init_node("sleeper")
            print(rospy.get_time())
            rospy.sleep(5)
            print(rospy.get_time())
            rospy.loginfo("told")
        """)
        assert await program.read_line() == "0.0"
        await clock.publish(Clock(fibws.Time(10)))
        said = asyncio.create_task(program.read_line())
        for second in count(11):  # Whenever the sleep begins, time goes on.
            await clock.publish(Clock(fibws.Time(second)))
            if (await asyncio.wait({said}, timeout=0.01))[0]:
                break
        later = float(said.result())
        assert later >= 15
        (line,) = await program.finish()
        assert line.endswith("]: told")
        assert ", " in line


async def test_node_can_ignore_simulated_time() -> None:
    async with running_hub() as programs, fibws.Node("clock", hub=programs.hub.url) as node:
        await node.params.set("/use_sim_time", True)
        assert await programs.run("""
            import rospy
            rospy.init_node("hasty", disable_rostime=True)
            print(rospy.get_time() > 1e9)
        """) == ["True"]
