"""Simulated time, which a node takes from the graph."""

from __future__ import annotations

import asyncio
from itertools import count

import fibws
from fibws.msg.rosgraph_msgs import Clock
from ros1.rospy.programs import world


async def test_a_node_keeps_to_the_time_of_the_graph() -> None:
    async with world() as it, fibws.Node("clock", hub=it.hub.url) as node:
        await node.params.set("/use_sim_time", True)
        clock = await node.advertise("/clock", Clock, latch=True)
        program = await it.start("""
            import rospy
            rospy.init_node("sleeper")
            print(rospy.get_time())
            rospy.sleep(5)
            print(rospy.get_time())
            rospy.loginfo("told")
        """)
        assert await program.says() == "0.0"
        await clock.publish(Clock(fibws.Time(10)))
        said = asyncio.create_task(program.says())
        for second in count(11):  # Whenever the sleep begins, time goes on.
            await clock.publish(Clock(fibws.Time(second)))
            if (await asyncio.wait({said}, timeout=0.01))[0]:
                break
        later = float(said.result())
        assert later >= 15
        (line,) = await program.ends()
        assert line.endswith("]: told")
        assert ", " in line


async def test_a_node_may_ignore_the_time_of_the_graph() -> None:
    async with world() as it, fibws.Node("clock", hub=it.hub.url) as node:
        await node.params.set("/use_sim_time", True)
        assert await it.run("""
            import rospy
            rospy.init_node("hasty", disable_rostime=True)
            print(rospy.get_time() > 1e9)
        """) == ["True"]
