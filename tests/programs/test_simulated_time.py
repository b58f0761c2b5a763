"""Nodes of a hub whose time is simulated."""

import fibws
from fibws.hub.server import HubServer
from fibws.msg.rosgraph_msgs import Clock, Log

MOMENT = fibws.Time(12, 34)


async def test_nodes_follow_the_clock(hub: HubServer) -> None:
    hub.graph.parameters.set("/use_sim_time", True)
    async with (
        fibws.Node("player", hub=hub.url, use_sim_time=False) as player,
        fibws.Node("robot", hub=hub.url) as robot,
    ):
        assert robot.now() == fibws.Time(0, 0)
        assert player.now() > MOMENT
        clock = await player.advertise("/clock", Clock)
        moments = robot.subscribe("/clock", Clock)
        await robot.flush()
        await clock.publish(MOMENT)
        await anext(moments)
        await robot.flush()
        assert robot.now() == MOMENT
        lines = player.subscribe("/rosout", Log)
        await player.flush()
        robot.log.info("hello")
        assert (await anext(lines)).header.stamp == MOMENT


async def test_time_is_the_systems_unless_the_parameter_is_set(hub: HubServer) -> None:
    async with fibws.Node("robot", hub=hub.url) as robot:
        assert robot.now() > MOMENT
        assert "/clock" not in hub.graph.topics
